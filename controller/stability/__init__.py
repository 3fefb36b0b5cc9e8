"""When the controlled actuator oscillates: model, limit cycles, theory of the sampled loop."""
