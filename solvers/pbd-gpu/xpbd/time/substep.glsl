// Steps of a vertex in a substep that lines and chains share, by the push constants `p` and the constant FEATURES of both.

/// a + b = sum + rest exactly (Knuth's two-sum).
void two_sum(vec3 a, vec3 b, out vec3 sum, out vec3 rest) {
  precise vec3 s = a + b;
  precise vec3 part = s - a;
  precise vec3 left = (a - (s - part)) + (b - part);
  sum = s;
  rest = left;
}

const bool kUsesBdf2 = (FEATURES & LINES_BDF2) != 0u;

/// v += g h - (1 - e^{-c h}) v, x += h v, both in compensated sums: with thousands of substeps per second the
/// increments fall below the last bit of x and v, and plain sums would freeze or drift. `rest_`: what the last sums
/// could not hold. `last_`: before the last substep, and then before this one. A prediction adds a fraction of what the
/// last substep changed (BDF2; the differences of close numbers are exact, and what their roundings leave out cancels
/// from substep to substep).
void fall(inout vec3 position, inout vec3 velocity, inout vec3 rest_position, inout vec3 rest_velocity,
          inout vec3 last_position, inout vec3 last_velocity) {
  vec3 gain = p.gravity_h.xyz, sum, rest, history = vec3(0.0);
  if (kUsesBdf2) {
    vec3 change = p.history_weight * (velocity - last_velocity);
    gain += change;
    gain -= p.damping_fraction * (velocity + change);
    history = p.history_weight * (position - last_position);
    last_velocity = velocity;
    last_position = position;
  } else {
    gain -= p.damping_fraction * velocity;
  }
  two_sum(velocity, gain + rest_velocity, sum, rest);
  velocity = sum;
  rest_velocity = rest;
  vec3 way = p.h * sum + rest_position;
  if (kUsesBdf2) way += history;
  two_sum(position, way, sum, rest);
  position = sum;
  rest_position = rest;
}

/// How far the prediction of an elastic cloth at rest falls in a substep [m]. A tether must leave it, or it would carry
/// the load in place of links; 0 for inextensible cloth, whose tethers are to carry it.
float prediction_fall() { return p.gravity_h.w > 0.0 ? p.h * length(p.gravity_h.xyz) : 0.0; }

/// The displacement back to within `reach` of what a tether ends at; 0 where it is slack.
vec3 tethered(vec3 position, vec3 end, float reach) {
  vec3 e = position - end;
  float square = dot(e, e);
  return square > reach * reach ? e * (reach * inversesqrt(square) - 1.0) : vec3(0.0);
}

const bool kTension = (FEATURES & LINES_TENSION) != 0u;
/// Least ratio of a link's alpha to inverse mass, in a chain pulled over-constrained between attached vertices; 0 in
/// others, where `smallest` is. `stretched`: length over rest length. Strips: tension must not turn a link by more than
/// a substep resolves, or it overshoots and throws what hangs on it; across itself a chain moves by x += L x,
/// L = dlambda w / l times per second difference, so dlambda w / l is held below 1. In sheets diagonals hold a kink. An
/// inextensible link torn to several times its length yields bit by bit. Implicit tension turns links by no more than
/// they can turn, so that elastic links need none of it.
float regularised(float smallest, bool elastic, float stretched) {
  if (kTension) return elastic ? 0.0 : smallest;
  if (smallest == 0.0 || (elastic && (FEATURES & LINES_SHEAR) != 0u)) return smallest;
  return max(smallest, elastic ? stretched - 1.0 : 4.0 * (stretched - 5.0));
}
