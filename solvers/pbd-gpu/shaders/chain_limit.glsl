// Links that are stretched beyond a limit of strain are held there: an active set of the chain's links, found by solving them
// again. Included by chain_pass.comp.
const uint kLimitRounds = 2u;

float limit_of(ChainEntry entry) { return entry.rest * (1.0 + uintBitsToFloat(LIMIT_BITS)); }

/// Of cloth whose triangles are elastic: where they have put the vertices.
void find_beyond_limit(ChainEntry entry) {
  vec4 none, next;
  exchange(vec4(pos, w), 1u, none, next);
  at_limit = entry.rest >= 0.0 && w + next.w > 0.0 && distance(next.xyz, pos) > limit_of(entry);
}

/// The multipliers with the links at the limit that the solution `lambda` would stretch farther, and without those that it
/// would have to push or that hold less than the spring would.
vec2 hold_at_limit(ChainEntry entry, uint rounds, float pull, vec2 lambda) {
  float soft = entry.compliance * p.per_h * p.per_h * p.per_keep, most = limit_of(entry);
  for (uint r = 0u; r < kLimitRounds; ++r) {
    vec4 none, above, next;
    exchange(vec4(w * (lambda.x * direction_below - lambda.y * direction), 0.0), 1u, none, above);
    exchange(vec4(pos, w), 1u, none, next);
    vec3 here = pos + w * (lambda.x * direction_below - lambda.y * direction), there = next.xyz + above.xyz;
    float tension = pull * link_length - lambda.y;
    if (at_limit) at_limit = tension > (kSprings ? (most - entry.rest) / soft : 0.0);
    else at_limit = entry.rest >= 0.0 && w + next.w > 0.0 && distance(here, there) > most;
    lambda = solve_links(entry, rounds, pull);
  }
  at_limit = false;
  return lambda;
}
