// Moves each free particle by the collisions of one kind, satisfied(). One thread per particle.
void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 particle = q[i];
  if (particle.w == 0.0) return;
  vec3 at = particle.xyz, from = FRICTION == 1u ? x[i].xyz : vec3(0.0);
  q[i] = vec4(satisfied(at, from), particle.w);
}
