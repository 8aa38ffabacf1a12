// Response of a contact with a half-space, a convex shape or another layer of cloth: XPBD contact at position level
// with zero compliance (Macklin et al. 2016) and Coulomb friction. `velocity_part` moves x and changes v by Δ/h';
// `depenetration`, along the normal, only moves x.
struct Correction {
  vec3 velocity_part;
  float depenetration;
};

/// Depenetration [m] of a contact whose gap is `lacking` [m] below its margin. Round 2 enforces only the target gap.
float recovery(float lacking, float margin) {
  return response_round < 2u ? clamp(lacking, 0.0, kRecovered * margin) : 0.0;
}

/// `correction`: by how much the gap is below its target [m]; `slip`: the relative displacement in this substep.
Correction respond_along(vec3 n, float correction, float recover, vec3 slip, float friction) {
  if (!(correction + recover > 0.0)) return Correction(vec3(0.0), 0.0);
  float velocity_part = max(0.0, correction);
  slip -= dot(slip, n) * n;
  float l = length(slip);
  vec3 by = velocity_part * n;
  if (l > 0.0 && velocity_part > 0.0) by -= min(1.0, friction * velocity_part / l) * slip;
  return Correction(by, correction + recover - velocity_part);
}
