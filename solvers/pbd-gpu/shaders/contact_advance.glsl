// Takes a point of the cloth from where it was at the substep's start, on the right side of everything, towards where
// integration and constraints have put it, without passing through anything on its path: conservative advancement
// (Mirtich 1996) in space and time, against planes. Where it is at the end is the side it remembers.
const uint kSteps = 8u;
bool touched;  // some contact was active

/// The contact's answer: no approach is left in the velocity, Coulomb friction takes of the rest, and the displacement left goes
/// no nearer than the margin. A push out of the margin moves the point but is no velocity: it would pop.
void respond_to(Touch t, inout vec3 vel) {
  vec3 surface = t.delta * p.frames_per_s;
  vec3 relative = vel - surface;
  float approach = max(0.0, -dot(relative, t.n));
  relative += approach * t.n;
  vec3 remaining = left - part * t.delta;
  float along = dot(remaining, t.n);
  vec3 slide = remaining - along * t.n;
  if (FRICTION == 1u) {
    float most = t.friction * approach;
    vec3 slip = relative - dot(relative, t.n) * t.n;
    float speed = length(slip), l = length(slide);
    if (speed > 0.0) relative -= slip * min(1.0, most / speed);
    if (l > 0.0) slide *= max(0.0, 1.0 - most * part / (p.frames_per_s * l));
  }
  vel = surface + relative;
  left = part * t.delta + slide + max(along, -t.gap) * t.n;
  active_normal = t.n;
  touched = true;
}

/// Where the point is at the substep's end; `vel` is its velocity. Points that are not `wanted` stay at `to`. `first_bound`: what it
/// has found about where it was.
vec3 search(vec3 from, vec3 to, uint owner, bool wanted, inout vec3 vel, out float first_bound) {
  first_bound = 0.0;
  at = from;
  left = to - from;
  now = p.begin;
  part = p.part;
  active_normal = vec3(0.0);
  touched = false;
  bool done = !wanted;
  vec3 end = to;
  for (uint k = 0u; k < kSteps; ++k) {
    if (!ANY(!done)) return end;
    query_proximity(owner, !done);
    if (done) continue;
    if (k == 0u) first_bound = bound;
    bool first = active_normal == vec3(0.0);
    // At first any need counts: what many small substeps fall is below the tolerance, and a cloth would creep down a slope
    // that holds it.
    float least = k == 0u ? 0.0 : kTolerance * nearest.margin;
    bool by_nearest = first && nearest.gap < kSlack * nearest.margin && nearest.need > least;
    bool by_other = !by_nearest && other.gap < kFar && (!first || dot(other.n, nearest.n) < kOther);
    if ((by_nearest || by_other) && k + 1u < kSteps) {
      if (by_nearest) respond_to(nearest, vel); else respond_to(other, vel);
      // A static collider cannot be reached by a displacement shorter than its distance. Else: is it free now?
      float spare = nearest.gap + (1.0 - kKeep) * nearest.margin;
      if (MOVING == 0u && !multiple_contacts && spare > 0.0 && dot(left, left) < spare * spare) {
        end = at + left;
        done = true;
      }
      continue;
    }
    // The path is free: not by the sum, from + (to - from) is not `to` in its last digit.
    if (k == 0u && free_part == 1.0) {
      done = true;
      continue;
    }
    at += free_part * left;
    now += free_part * part;
    left *= 1.0 - free_part;
    part *= 1.0 - free_part;
    active_normal = vec3(0.0);
    // An unfinished search counts as a hit: the point goes no further than what is next to it.
    end = free_part == 1.0 ? at : at + part * nearest.delta;
    done = free_part == 1.0;
  }
  return end;
}

/// The same. `spare`: contact with anything is at least this far from `from`. A vertex that moves less needs no search.
vec3 advance(vec3 from, vec3 to, uint owner, bool wanted, inout vec3 vel, inout float spare) {
  float others = p.part * carried();
  bool looks = wanted && !(distance(from, to) + others < spare);
  float first_bound;
  vec3 end = search(from, to, owner, looks, vel, first_bound);
  if (looks) spare = first_bound;
  spare -= distance(from, end) + others;
  return end;
}
