// Steps of a vertex in a substep, shared by lines and chains. Both have push constants `p` and a constant FEATURES.

/// a + b = sum + rest exactly (Knuth's two-sum).
void two_sum(vec3 a, vec3 b, out vec3 sum, out vec3 rest) {
  precise vec3 s = a + b;
  precise vec3 part = s - a;
  precise vec3 left = (a - (s - part)) + (b - part);
  sum = s;
  rest = left;
}

float kick_scale = 1.0;  // of this substep (TimeStep)
/// kick_scale of a substep of p.h after one of `last_h`, or after none (0).
float kick_scale_after(float last_h) { return last_h > 0.0 ? 0.5 + 0.5 * (last_h / p.h) : 1.0; }

const bool kUsesBdf2 = (FEATURES & LINES_BDF2) != 0u;

/// Prediction: v += kick_scale (g h - (1 - e^{-c h}) v), x += h v, both in compensated sums: with thousands of substeps
/// per second the increments fall below the last bit of x and v, and plain sums would freeze or drift. `rest_`: rounding
/// errors of the last sums. `last_`: state before the last substep; becomes the state before this one. BDF2 also adds a
/// fraction of the last substep's change; a difference of close numbers is exact, and the rounding errors that it leaves
/// out cancel from substep to substep.
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
    gain = kick_scale * (gain - p.damping_fraction * velocity);
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

/// Distance that the prediction of elastic cloth at rest falls in a substep [m]. Tethers must allow it, otherwise they
/// would carry the load instead of the links. 0 for inextensible cloth, whose tethers should carry the load.
float prediction_fall() { return p.gravity_h.w > 0.0 ? p.h * length(p.gravity_h.xyz) : 0.0; }

/// Displacement that brings a vertex back to within `reach` [m] of its tether's end; 0 if the tether is slack.
vec3 tethered(vec3 position, vec3 end, float reach) {
  vec3 e = position - end;
  float square = dot(e, e);
  return square > reach * reach ? e * (reach * inversesqrt(square) - 1.0) : vec3(0.0);
}

const bool kTension = (FEATURES & LINES_TENSION) != 0u;
/// Minimum ratio of a link's alpha to inverse mass. Only over-constrained chains have one; `smallest` is 0 in others.
/// `stretched`: length divided by rest length. Elastic strips: tension must not turn a link by more than a substep
/// resolves, otherwise the link overshoots and throws the cloth below it. Tension moves vertices across the chain by
/// dlambda w / l times their second difference, so dlambda w / l is kept below 1. In elastic sheets diagonals resist
/// this. An inextensible link torn to several times its length yields gradually. With implicit tension a link cannot
/// overshoot, so elastic links need no minimum.
float regularised(float smallest, bool elastic, float stretched) {
  if (kTension) return elastic ? 0.0 : smallest;
  if (smallest == 0.0 || (elastic && (FEATURES & LINES_SHEAR) != 0u)) return smallest;
  return max(smallest, elastic ? stretched - 1.0 : 4.0 * (stretched - 5.0));
}
