#version 450
// Solves one colour of chains (xpbd/mesh/README.md). A thread holds a vertex and the link to the next entry; a
// workgroup holds a block of whole chains. The links of a chain are a tridiagonal system in their multipliers, solved
// by parallel cyclic reduction. The first colour of a substep contains every vertex and also predicts it. A mesh with
// bending has passes before the first colour: the prediction, then the iterations of bending, one thread per vertex.
// With MEMBRANE these iterations include triangles, and there are no colours. PERSISTENT: a dispatch executes any
// number of passes instead of one.
#include "common/common.glsl"
CHAIN_CONSTANTS(SPECIALIZE)
layout(std430, binding = BIND_POSITIONS) coherent buffer Positions { vec4 x[]; };  // w: inverse mass
layout(std430, binding = BIND_VELOCITIES) coherent buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_POSITION_COMPENSATION) buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) buffer VelocityCompensation { vec4 rv[]; };
layout(std430, binding = BIND_LAST_POSITIONS) buffer LastPositions { vec4 lx[]; };
layout(std430, binding = BIND_LAST_VELOCITIES) buffer LastVelocities { vec4 lv[]; };
layout(std430, binding = BIND_CHAIN_ENTRIES) readonly buffer Entries { ChainEntry entries[]; };
layout(std430, binding = BIND_TETHER_ENDS) readonly buffer TetherEnds { TetherEnd tether_ends[]; };  // by vertex
layout(std430, binding = BIND_CHAIN_COLOURS) readonly buffer Ranges { ChainRange ranges[]; };
layout(std430, binding = BIND_BENDING_SLICES) readonly buffer Slices { BendingSlice slices[]; };
layout(std430, binding = BIND_BENDING_ENTRIES) readonly buffer BendingEntries { BendingEntry bending[]; };
// Arrays by vertex: right sides, steps of odd iterations, steps of even iterations; with MEMBRANE also positions.
layout(std430, binding = BIND_BENDING_STEPS) coherent buffer BendingSteps { vec4 bent[]; };
layout(push_constant) uniform Push { ChainConstants p; };
#include "xpbd/time/substep.glsl"
#include "common/grid_barrier.glsl"
#ifdef MEMBRANE
#include "xpbd/mesh/membrane.glsl"
#endif

vec3 pos, vel, rest_pos, rest_vel, last_pos, last_vel;
float w;

void move(vec3 step) {
  pos += step;
  vel += step * p.per_h;
}

/// Predicts vertex i and applies its tethers. Pinned vertices are never written, so reading them cannot race.
void integrate(uint i) {
  fall(pos, vel, rest_pos, rest_vel, last_pos, last_vel);
  for (uint t = 0u; t < TETHERS; ++t) {
    TetherEnd end = tether_ends[TETHERS * i + t];
    if (end.reach < 0.0) continue;
    vec3 back = tethered(pos, x[end.to].xyz, end.reach + prediction_fall());
    if (back != vec3(0.0)) move(back);
  }
}

#ifdef MEMBRANE
void stretch(ChainEntry entry, uint rounds) {}  // triangles replace links
#else
// exchange() gives the values of the entries n before and n after; beyond the block: 0. Double buffer: while some
// threads still read one half, others write the other.
shared vec4 exchanged[2u * THREADS];
uint exchange_half = 0u;
void exchange(vec4 mine, uint n, out vec4 below, out vec4 above) {
  uint here = exchange_half, thread = gl_LocalInvocationIndex;
  exchange_half = THREADS - exchange_half;
  exchanged[here + thread] = mine;
  barrier();
  below = thread >= n ? exchanged[here + thread - n] : vec4(0.0);
  above = thread + n < THREADS ? exchanged[here + thread + n] : vec4(0.0);
}

vec3 direction, direction_below;  // unit vectors along the thread's link and the one before; 0: no link
float link_length;

/// Solves the links of the chain at the current positions, starting from tension / length `pull`. Returns the
/// multipliers of the link before (x) and of the thread's link (y).
vec2 solve_links(ChainEntry entry, uint rounds, float pull) {
  vec4 none, next, below, above;
  exchange(vec4(pos, w), 1u, none, next);
  vec3 e = next.xyz - pos;
  float square = dot(e, e), sum = w + next.w;
  bool is = entry.rest >= 0.0 && sum > 0.0 && square > 0.0;
  float per_l = inversesqrt(square), l = square * per_l;
  vec3 g = is ? e * per_l : vec3(0.0);
  float stretched = entry.rest > 0.0 ? l / entry.rest : 1.0;
  float soft = max(entry.compliance * p.per_h * p.per_h * p.per_force_scale,
                   regularised(entry.regularisation, entry.compliance != 0.0, stretched) * max(w, next.w));
  exchange(vec4(g, 0.0), 1u, below, above);
  float per_diagonal = is ? 1.0 / (sum + soft) : 1.0;
  float right = entry.rest - l;
  if (kTension) right += soft * pull * l;
  // The link's equation. x, y: coefficients of the links before and after; z: right side; the diagonal is 1.
  vec3 row = is ? vec3(-w * dot(below.xyz, g), -next.w * dot(g, above.xyz), right) * per_diagonal : vec3(0.0);
  direction = g;
  direction_below = below.xyz;
  link_length = l;
  for (uint r = 0u; r < rounds; ++r) {
    exchange(vec4(row, 0.0), 1u << r, below, above);
    float per = 1.0 / (1.0 - row.x * below.y - row.y * above.x);
    row = vec3(-row.x * below.x, -row.y * above.y, row.z - row.x * below.z - row.y * above.z) * per;
  }
  exchange(vec4(row, 0.0), 1u, below, above);
  return vec2(below.z, row.z);
}

/// Moves the vertices by zero-length springs of tension / length `pull` (tension.glsl). A chain has one more vertex
/// than links, so this system needs one more round.
void turn(float pull, uint rounds) {
  vec4 below, above, right_below, right_above;
  exchange(vec4(pos, pull), 1u, below, above);
  float before = w * below.w, after = w * pull, per = 1.0 / (1.0 + before + after);
  vec3 right = (before * (below.xyz - pos) + after * (above.xyz - pos)) * per;
  vec2 row = vec2(-before, -after) * per;  // coefficients of the vertices before and after; the diagonal is 1
  for (uint r = 0u; r <= rounds; ++r) {
    exchange(vec4(row, 0.0, 0.0), 1u << r, below, above);
    exchange(vec4(right, 0.0), 1u << r, right_below, right_above);
    per = 1.0 / (1.0 - row.x * below.y - row.y * above.x);
    right = (right - row.x * right_below.xyz - row.y * right_above.xyz) * per;
    row = vec2(-row.x * below.x, -row.y * above.y) * per;
  }
  if (w > 0.0) move(right);
}

void stretch(ChainEntry entry, uint rounds) {
  float pull = 0.0;
  if (kTension) {
    float lambda = solve_links(entry, rounds, 0.0).y;
    pull = direction != vec3(0.0) ? max(-lambda, 0.0) / link_length : 0.0;
    turn(pull, rounds);
  }
  vec2 lambda = solve_links(entry, rounds, pull);
  move(w * (lambda.x * direction_below - lambda.y * direction));
}
#endif

void pass(uint number, bool first, bool links, uint rounds) {
  ChainEntry entry = entries[number];
  bool is = entry.vertex != CHAIN_NO_VERTEX;
  uint i = is ? entry.vertex : 0u;
  pos = vel = rest_pos = rest_vel = last_pos = last_vel = vec3(0.0);
  w = 0.0;
  if (is) {
    vec4 here = x[i];
    pos = here.xyz;
    w = here.w;
    vel = v[i].xyz;
    if (first) {
      rest_pos = rx[i].xyz;
      rest_vel = rv[i].xyz;
      if (kUsesBdf2) {
        last_pos = lx[i].xyz;
        last_vel = lv[i].xyz;
      }
      if (w > 0.0) integrate(i);
    }
  }
  if (links) stretch(entry, rounds);
  if (w == 0.0) return;
  x[i] = vec4(pos, w);
  v[i] = vec4(vel, 0.0);
  if (!first) return;
  rx[i] = vec4(rest_pos, 0.0);
  rv[i] = vec4(rest_vel, 0.0);
  if (!kUsesBdf2) return;
  lx[i] = vec4(last_pos, 0.0);
  lv[i] = vec4(last_vel, 0.0);
}

const bool kBends = (FEATURES & LINES_BEND) != 0u;
#ifdef MEMBRANE
const bool kSolves = true;
#else
const bool kSolves = kBends;
#endif
float weight = 2.0;     // of iteration `weight_of` of bending
uint weight_of = 1u;

/// Weight of Chebyshev's iteration k (at least 2); bit-identical whether a dispatch executes one pass or all.
float weight_at(uint k) {
  if (k < weight_of) {
    weight = 2.0;
    weight_of = 1u;
  }
  for (; weight_of < k; ++weight_of) weight = 1.0 / (1.0 - p.bending_spread * weight);
  return weight;
}

/// K times the steps (if k = 1, the positions). Sums differences, which lose no digits; rows of K sum to 0.
vec3 bending_force(uint i, uint k, uint before, vec3 mine) {
  vec3 force = vec3(0.0);
  BendingSlice slice = slices[i / BENDING_ROWS];
  uint at = slice.first + i % BENDING_ROWS;
  for (uint j = 0u; j < slice.width; ++j) {
    BendingEntry entry = bending[at + BENDING_ROWS * j];
    vec3 other = k > 1u ? bent[before + entry.column].xyz : x[entry.column].xyz;
    force += entry.stiffness * (other - mine);
  }
  return force;
}

#ifdef MEMBRANE
/// Force of the triangles: in iteration k = 1 from their elongations, later linear in the steps. Later iterations use
/// the positions that the first one stored, because the last one overwrites x.
vec3 triangle_force(uint i, uint k, uint before, vec3 here, vec3 mine) {
  vec3 pull = vec3(0.0);
  BendingSlice slice = membrane_slices[i / BENDING_ROWS];
  uint at = slice.first + i % BENDING_ROWS, found = 3u * p.vertices;
  for (uint j = 0u; j < slice.width; ++j) {
    MembraneCorner c = corners[at + BENDING_ROWS * j];
    if (c.a == CHAIN_NO_VERTEX) continue;
    if (k == 1u)
      pull += membrane_force(c, here, x[c.a].xyz, x[c.b].xyz);
    else
      pull += membrane_change(c, here, bent[found + c.a].xyz, bent[found + c.b].xyz, mine,
                              bent[before + c.a].xyz, bent[before + c.b].xyz);
  }
  return -pull;
}
#endif

/// An iteration for the d at which x + d balances bending: (1 + c M^-1 K) d = -c M^-1 K x, c = h'^2 k (TimeStep), with
/// eigenvalues in [1, 1 + m] (Chebyshev's semi-iteration; Golub & Varga 1961).
void bend(uint i, uint k) {
  uint odd = p.vertices, even = 2u * p.vertices, now = k % 2u != 0u ? odd : even, before = odd + even - now;
  vec4 here = x[i];
#ifdef MEMBRANE
  if (k == 1u) bent[3u * p.vertices + i] = here;
#endif
  if (here.w == 0.0) {  // attached vertices have no step; one may have been free in the last frame
    if (k < p.bending_iterations) bent[now + i] = vec4(0.0);
    return;
  }
  vec3 mine = k > 1u ? bent[before + i].xyz : here.xyz, force = vec3(0.0);
  if (kBends) force = bending_force(i, k, before, mine);
#ifdef MEMBRANE
  force += triangle_force(i, k, before, here.xyz, mine);
#endif
  vec3 step = -p.bending_step * here.w * force;
  if (k == 1u) {
    if (k < p.bending_iterations) bent[i] = vec4(step, 0.0);
    step *= p.bending_gain;
  } else {
    vec3 last = k > 2u ? bent[now + i].xyz : vec3(0.0);
    step += bent[i].xyz - mine;
    step = last + weight_at(k) * (p.bending_gain * step + mine - last);
  }
  if (k < p.bending_iterations) {
    bent[now + i] = vec4(step, 0.0);
    return;
  }
  pos = here.xyz;
  vel = v[i].xyz;
  move(step);
  x[i] = vec4(pos, here.w);
  v[i] = vec4(vel, 0.0);
}

void main() {
  if (PERSISTENT && p.passes == 0u && !grid_barrier()) return;  // runs_at_once(): only tests the barrier
  uint block = item() / THREADS;
  for (uint n = p.first_pass; n < p.first_pass + p.passes; ++n) {
    if (PERSISTENT && n > p.first_pass && !grid_barrier()) return;
    uint bends = kSolves ? 1u + p.bending_iterations : 0u, number = n % (p.colours + bends);
    if (kSolves && number > 0u && number < bends) {
      if (item() < p.vertices) bend(item(), number);
      continue;
    }
    uint f = number < bends ? 0u : number - bends;
    ChainRange range = ChainRange(p.first_entry, block + 1u, p.rounds);
    if (PERSISTENT) range = ranges[f];
    if (block < range.blocks)
      pass(range.first_entry + item(), number == 0u && p.again == 0u, number >= bends, range.rounds);
  }
  if (PERSISTENT) leave_grid_barrier();
}
