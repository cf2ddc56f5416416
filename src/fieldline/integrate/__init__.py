"""Steps of explicit Runge-Kutta methods, the state within a step, and crossings of zero; knows no physics."""
