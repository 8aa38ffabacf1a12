// Moves each free particle by the collisions of one kind, satisfied(). One thread per particle.
void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 particle = q[i];
  if (particle.w == 0.0) return;
  vec3 from = FRICTION > 0u || PROJECT_PREVIOUS == 1u ? x[i].xyz : vec3(0.0);
  side = OPPOSITE_NORMALS == 1u && i >= p.layer ? -1.0 : 1.0;
  vec3 at = PROJECT_PREVIOUS == 1u ? from : particle.xyz;
  vec3 to = satisfied(at, from);
  if (PROJECT_PREVIOUS == 1u) to = particle.xyz + (to - at);
  q[i] = vec4(to, particle.w);
  if (FRICTION == 2u) slip[i] = vec4(slip[i].xyz + removed, 0.0);
}
