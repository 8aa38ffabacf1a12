// What the kernels of plane contact know of a vertex.
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };      // w: inverse mass in the lines
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) buffer Proposed { vec4 y[]; };       // w: inverse mass
layout(std430, binding = BIND_STARTS) buffer Starts { vec4 starts[]; };       // at the substep's start; w: farthest it may go
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };

/// How far a vertex may go from its start: its proposed way, and what a collider may push it.
float farthest(uint i, vec3 to) {
  return distance(to, starts[i].xyz) + p.part * ledger.carried + p.margin_m;
}
