"""A line of nodes once more, in NumPy, from a scenario's record: nothing of `fieldline.dynamics`.

Points as a list, forces summed segment by segment; a reel by the momentum of what leaves it, with the rate of that
momentum taken by differences of the streaming velocity.
"""

import numpy as np
from scipy.spatial.transform import Rotation


class TextbookLine:
    """rates (6 a node), feed_rates (2,), on_bodies [(body, force_i, torque_b)], end_masses [(body, mass, place or None)]."""

    def __init__(self, book, k, line, nodes, feed, slider):
        self.book, self.k, self.line = book, k, line
        self.length, self.speed = book.tail[feed], book.tail[feed + 1]
        whole = line.rest_length_m if line.reel is None else line.reel.total_length_m
        self.full = whole / (line.nodes + 1)
        self.count = int(book.nodes_out[k])
        self.ends = [self._end(end, slider) for end in ("from", "to")]
        state = book.tail[nodes : nodes + 6 * self.count].reshape(-1, 6)
        self.places = [self.ends[0]["place"], *state[:, :3], self.ends[1]["place"]]
        self.rates_of = [self.ends[0]["speed"], *state[:, 3:], self.ends[1]["speed"]]
        self.rests = [self.full] * self.count + [self.length]
        self.loads = [np.zeros(3) for _ in self.places]
        self.on_bodies, self.end_masses = [], []
        self._pulls()
        self._masses()
        self._reel()
        self._settle(state)

    def _end(self, end, slider):
        """Body, attitude, lever, place and velocity of an attachment."""
        b = self.book.scenario.index_of(getattr(self.line, f"{end}_body"))
        row = self.book.rows[b]
        point, moving = np.array(getattr(self.line, f"{end}_point_b_m"), dtype=float), np.zeros(3)
        for j, one in enumerate(self.line.slider, slider):
            if one.end == end:
                start, goal, since = (getattr(self.book.inputs, key)[j] for key in ("slide_from", "slide_to", "slide_since"))
                way, gone = goal - start, one.speed_m_s * (self.book.t - since)
                there = gone >= abs(way)
                point = point + (goal if there else start + np.sign(way) * gone) * np.array(one.axis_b)
                moving = moving + (0.0 if there else np.sign(way) * one.speed_m_s) * np.array(one.axis_b)
        turn = Rotation.from_quat(row[6:10])
        speed = row[3:6] + turn.apply(np.cross(row[10:13], point) + moving)
        return {
            "b": b,
            "turn": turn,
            "point": point,
            "place": row[:3] + turn.apply(point),
            "speed": speed,
            "omega": row[10:13],
            "moving": moving,
        }

    def _pulls(self):
        """Tension of every segment, and damping of the angle at the ends."""
        line = self.line
        for j, rest in enumerate(self.rests):
            chord = self.places[j + 1] - self.places[j]
            length = np.linalg.norm(chord)
            strain_rate = chord @ (self.rates_of[j + 1] - self.rates_of[j]) / length / rest
            if j == self.count:
                strain_rate -= length * self.speed / rest**2
            self.tension = 0.0
            if length > rest:
                self.tension = max(0.0, line.stiffness_n * (length / rest - 1.0) + line.damping_n_s * strain_rate)
            pull = self.tension * chord / length
            self.loads[j] = self.loads[j] + pull
            self.loads[j + 1] = self.loads[j + 1] - pull
            taut = self.tension > 0.0
            if taut and j == 0 and line.from_joint_damping_n_m_s:
                self._joint(self.ends[0], line.from_joint_damping_n_m_s, 0, 1)
            if taut and j == self.count and line.to_joint_damping_n_m_s:
                self._joint(self.ends[1], line.to_joint_damping_n_m_s, self.count + 1, self.count)

    def _joint(self, end, beta, near, far):
        """beta times the rate of the angle between lever and line, by differencing both directions over a moment."""

        def angle(dt):
            lever = end["turn"].apply(Rotation.from_rotvec(end["omega"] * dt).apply(end["point"]))
            chord = (self.places[far] - self.places[near]) + dt * (self.rates_of[far] - self.rates_of[near])
            across = np.cross(lever, chord)
            return np.arctan2(np.linalg.norm(across), lever @ chord), across / np.linalg.norm(across)

        h = 1e-3
        rate = (8.0 * (angle(h)[0] - angle(-h)[0]) - (angle(2 * h)[0] - angle(-2 * h)[0])) / (12.0 * h)
        self.on_bodies.append((end["b"], np.zeros(3), end["turn"].inv().apply(beta * rate * angle(0.0)[1])))

    def _masses(self):
        """Half of each segment to either point."""
        linear = self.line.mass_per_length_kg_m
        self.mass = np.zeros(len(self.places))
        for j, rest in enumerate(self.rests):
            self.mass[j] += 0.5 * linear * rest
            self.mass[j + 1] += 0.5 * linear * rest

    def _reel(self):
        """The feed, and what the momentum of the material that it speeds up asks of the node and of the reel."""
        reel, linear = self.line.reel, self.line.mass_per_length_kg_m
        self.feed_rates = np.zeros(2)
        if reel is None:
            return
        told = self.book.inputs.reel[self.k]
        slows = reel.mode == "rate"
        change = (told - self.speed) / reel.lag_s if slows else (self.tension - told) / reel.effective_mass_kg
        self.feed_rates = np.array([self.speed, change])
        away, away_rate = self.places[-2] - self.places[-1], self.rates_of[-2] - self.rates_of[-1]

        def streaming(dt):
            return (self.speed + dt * change) * (away + dt * away_rate) / (self.length + dt * self.speed)

        h = 1e-2
        speeding = (8.0 * (streaming(h) - streaming(-h)) - (streaming(2 * h) - streaming(-2 * h))) / (12.0 * h)
        flow, leaving = linear * self.speed, streaming(0.0)
        middle = 0.5 * (leaving + away_rate)
        self.loads[-2] = self.loads[-2] + 0.5 * flow * (middle - away_rate)
        half = 0.5 * linear * self.length
        self.loads[-1] = self.loads[-1] - 0.5 * flow * middle - 0.5 * flow * leaving - half * speeding
        gone = linear * (sum(self.rests) - self.line.rest_length_m)
        end = self.ends[1]
        self.end_masses.append((end["b"], -gone, None))
        self.on_bodies.append((end["b"], -gone * self.book.pull(self.book.rows[end["b"], :3]), np.zeros(3)))
        self._passage(linear * self.speed, linear * change, end)

    def _passage(self, flow, flow_rate, end):
        """Line on its way from the reel in the body's middle to the attachment: what speeds it up and carries it round."""
        arm, turning = end["point"], np.cross(end["omega"], end["point"]) + end["moving"]
        force = -flow_rate * arm - 2.0 * flow * turning
        self.on_bodies.append((end["b"], end["turn"].apply(force), np.cross(0.5 * arm, force)))

    def _settle(self, state):
        """Accelerations of the nodes; the ends' loads, with the weight of their half segments, to the bodies."""
        rates = np.zeros((self.line.nodes, 6))
        for j in range(self.count):
            rates[j, :3] = state[j, 3:]
            rates[j, 3:] = self.loads[j + 1] / self.mass[j + 1] + self.book.pull(state[j, :3])
        self.rates = rates.ravel()
        for end, j in zip(self.ends, (0, -1), strict=True):
            force = self.loads[j] + self.mass[j] * self.book.pull(end["place"])
            force = force - 2.0 * self.mass[j] * end["turn"].apply(np.cross(end["omega"], end["moving"]))
            self.on_bodies.append((end["b"], force, np.cross(end["point"], end["turn"].inv().apply(force))))
            if self.mass[j] > 0.0:
                self.end_masses.append((end["b"], self.mass[j], end["point"]))
