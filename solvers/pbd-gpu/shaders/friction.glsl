// The response of every contact: with a half-space, a piece, or another layer (Macklin et al. 2016, XPBD's position-level contact
// with zero compliance; Coulomb friction). A correction has a part that is velocity, and one along the normal that is none.
struct Correction {
  vec3 moving;
  float out_by;
};

/// By how much what is `lacking` [m] to a margin is let out in this turn.
float recovery(float lacking, float margin) { return turn < 2u ? clamp(lacking, 0.0, kRecovered * margin) : 0.0; }

/// `push`: by how much the contact has come too near in this substep [m]; `slip`: its relative displacement.
Correction respond_along(vec3 n, float push, float recover, vec3 slip, float friction) {
  if (!(push + recover > 0.0)) return Correction(vec3(0.0), 0.0);
  float moving = max(0.0, push);
  slip -= dot(slip, n) * n;
  float l = length(slip);
  vec3 by = moving * n;
  if (l > 0.0 && moving > 0.0) by -= min(1.0, friction * moving / l) * slip;
  return Correction(by, push + recover - moving);
}
