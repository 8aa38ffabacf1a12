// XPBD with a direct solve of whole grid lines (xpbd/lines/README.md). A chain is a line of one of four colours: 0
// rows, 1 columns, 2 and 3 diagonals. Diagonals wrap around the cloth's sides, where they have no link, so that all
// have ROWS vertices. LANES threads hold a chain, K consecutive vertices each: pos, vel and w (inverse mass) below.
LINE_CONSTANTS(SPECIALIZE)
layout(push_constant) uniform Push { LineConstants p; };
layout(std430, binding = BIND_REGULARISATION) readonly buffer Regularisation { float regularisation[]; };  // by chain

#include "xpbd/time/substep.glsl"
const bool kBends = (FEATURES & LINES_BEND) != 0u;
const bool kShears = (FEATURES & LINES_SHEAR) != 0u;
const bool kElastic = (FEATURES & LINES_ELASTIC) != 0u;
const bool kCorrectsSplitting = (FEATURES & LINES_SPLITTING) != 0u;

uint thread, lane, chain, colour;
vec3 pos[K], vel[K];
float w[K];

uint chain_length() { return colour == 0u ? COLUMNS : ROWS; }
uint chain_count() { return colour == 0u ? ROWS : COLUMNS; }
bool on_chain(uint i) { return EXACT ? i < COLUMNS : chain < chain_count() && i < chain_length(); }

/// Column and row of vertex i of the chain.
uvec2 vertex(uint i) {
  if (colour == 0u) return uvec2(i, chain);
  if (colour == 1u) return uvec2(chain, i);
  return uvec2((colour == 2u ? chain + i : chain + COLUMNS - i % COLUMNS) % COLUMNS, i);
}

uint index_of(uvec2 v) { return v.y * COLUMNS + v.x; }

/// Is there a link from vertex i to vertex i + 1?
bool goes_on(uint i) {
  if (!on_chain(i + 1u)) return false;
  if (colour < 2u) return true;
  uint column = vertex(i).x;
  return colour == 2u ? column + 1u < COLUMNS : column > 0u;
}

/// Lines on the border carry half the width, so they are twice as compliant.
float border() { return colour < 2u && (chain == 0u || chain + 1u == chain_count()) ? 2.0 : 1.0; }

// exchange() gives the values of the threads n before and n after on the same chain; beyond its ends they are arbitrary
// but finite. It uses shuffles within a subgroup, otherwise shared memory.
void set_thread() { thread = gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }
const uint PARTS = LANES * BESIDE > SUBGROUP ? LANES * BESIDE / SUBGROUP : 1u;  // subgroups that a chain spans
const uint PART = LANES / PARTS;                                               // threads of a chain per subgroup
const uint EXCHANGE_SIZE = PARTS > 1u ? 2u * THREADS : 1u;
bool apart = false;  // whether rows are coupled only to rows in the same subgroup

// Double buffer: while some threads still read one half, others write the other.
shared vec4 exchanged[EXCHANGE_SIZE];
uint exchange_half = 0u;
uint publish(vec4 mine) {
  uint here = exchange_half;
  exchange_half = THREADS - exchange_half;
  exchanged[here + thread] = mine;
  barrier();  // wait for all writes before threads read their neighbours' values
  return here;
}

void exchange(vec4 mine, uint n, out vec4 below, out vec4 above) {
  if (PARTS == 1u || apart) {
    uint self = gl_SubgroupInvocationID, at = lane % PART;
    below = subgroupShuffle(mine, at >= n ? self - n * BESIDE : self);
    above = subgroupShuffle(mine, at + n < PART ? self + n * BESIDE : self);
    return;
  }
  uint here = publish(mine);
  below = exchanged[here + (lane >= n ? thread - n * BESIDE : thread)];
  above = exchanged[here + (lane + n < LANES ? thread + n * BESIDE : thread)];
}

/// After log2(PARTS) rounds of cyclic reduction, rows PARTS apart form a separate system: the thread swaps its row for
/// one of the system that its subgroup solves.
vec4 to_part(vec4 mine) {
  uint here = publish(mine);
  return exchanged[here + thread + (lane % PART * PARTS + lane / PART - lane) * BESIDE];
}

/// Undoes to_part(): returns the thread's own row; `below`: the row before it (any finite value at a chain's start).
vec4 from_part(vec4 mine, out vec4 below) {
  uint start = publish(mine) + thread - lane * BESIDE, last = lane > 0u ? lane - 1u : 0u;
  below = exchanged[start + (last % PARTS * PART + last / PARTS) * BESIDE];
  return exchanged[start + (lane % PARTS * PART + lane / PARTS) * BESIDE];
}

// The three functions above for a row of a system: one overload per type of entry, for tridiagonal.glsl.
float link_lower[K], link_diagonal[K], link_upper[K], link_right[K];
float inverse_of(float x) { return 1.0 / x; }
void exchange_row(uint n, float a, float c, float d, out float a_below, out float c_below, out float d_below,
                  out float a_above, out float c_above, out float d_above) {
  vec4 below, above;
  exchange(vec4(a, c, d, 0.0), n, below, above);
  a_below = below.x; c_below = below.y; d_below = below.z;
  a_above = above.x; c_above = above.y; d_above = above.z;
}
void to_part(inout float a, inout float c, inout float d) {
  vec4 row = to_part(vec4(a, c, d, 0.0));
  a = row.x; c = row.y; d = row.z;
}
void from_part(inout float d, out float d_below) {
  vec4 below;
  d = from_part(vec4(d), below).x;
  d_below = below.x;
}
#define SOLVE solve_links
#define MATRIX float
#define VECTOR float
#define M K
#define LOWER link_lower
#define DIAGONAL link_diagonal
#define UPPER link_upper
#define RIGHT link_right
#include "xpbd/lines/tridiagonal.glsl"

// A hinge is coupled to two hinges on either side, so with two hinges per block the system is tridiagonal in blocks.
const uint BLOCKS = K > 1u ? K / 2u : 1u;
mat2 hinge_lower[BLOCKS], hinge_diagonal[BLOCKS], hinge_upper[BLOCKS];
mat3x2 hinge_right[BLOCKS];  // one column per coordinate
mat2 inverse_of(mat2 x) { return inverse(x); }
void exchange_row(uint n, mat2 a, mat2 c, mat3x2 d, out mat2 a_below, out mat2 c_below, out mat3x2 d_below,
                  out mat2 a_above, out mat2 c_above, out mat3x2 d_above) {
  vec4 below, above;
  exchange(vec4(a[0], a[1]), n, below, above);
  a_below = mat2(below.xy, below.zw);
  a_above = mat2(above.xy, above.zw);
  exchange(vec4(c[0], c[1]), n, below, above);
  c_below = mat2(below.xy, below.zw);
  c_above = mat2(above.xy, above.zw);
  vec4 z_below, z_above;
  exchange(vec4(d[0], d[1]), n, below, above);
  exchange(vec4(d[2], 0.0, 0.0), n, z_below, z_above);
  d_below = mat3x2(below.xy, below.zw, z_below.xy);
  d_above = mat3x2(above.xy, above.zw, z_above.xy);
}
void to_part(inout mat2 a, inout mat2 c, inout mat3x2 d) {
  vec4 row = to_part(vec4(a[0], a[1]));
  a = mat2(row.xy, row.zw);
  row = to_part(vec4(c[0], c[1]));
  c = mat2(row.xy, row.zw);
  row = to_part(vec4(d[0], d[1]));
  d = mat3x2(row.xy, row.zw, to_part(vec4(d[2], 0.0, 0.0)).xy);
}
void from_part(inout mat3x2 d, out mat3x2 d_below) {
  vec4 below, z_below, row = from_part(vec4(d[0], d[1]), below);
  d = mat3x2(row.xy, row.zw, from_part(vec4(d[2], 0.0, 0.0), z_below).xy);
  d_below = mat3x2(below.xy, below.zw, z_below.xy);
}
#define SOLVE solve_hinges
#define MATRIX mat2
#define VECTOR mat3x2
#define M BLOCKS
#define LOWER hinge_lower
#define DIAGONAL hinge_diagonal
#define UPPER hinge_upper
#define RIGHT hinge_right
#include "xpbd/lines/tridiagonal.glsl"

void move(uint k, vec3 step) {
  pos[k] += step;
  vel[k] += step * p.per_h;
}

#include "xpbd/lines/splitting_correction.glsl"

vec3 direction[K], direction_below;  // unit vectors along the links; 0: no link
float w_above;                       // inverse mass of the vertex after the thread's
float link_length[K], pull[K];  // pull: tension / length at the start of the solve

/// Compliance of the chain's links, divided by h'^2 and all factors of forces [1/kg] (TimeStep).
float compliance() {
  return (colour == 0u ? p.alpha_u : colour == 1u ? p.alpha_v : p.alpha_d) * border() / kick_scale;
}

/// Sets up one system for all links of the chain (Macklin, Mueller & Chentanez 2016, eq. 18):
/// (G M^-1 G^T + alpha) dlambda = -C - alpha lambda. `smallest`: minimum ratio of alpha to inverse mass.
void link_equations(float smallest) {
  vec4 below, above, none;
  exchange(vec4(pos[0], w[0]), 1u, none, above);
  w_above = above.w;
  float alpha = compliance();
  if (kCorrectsSplitting) alpha *= at_once();
  float rest = colour == 0u ? p.rest_u : colour == 1u ? p.rest_v : p.rest_d;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    vec4 next = above;
    if (k + 1u < K) next = vec4(pos[k + 1u], w[k + 1u]);
    vec3 e = next.xyz - pos[k];
    float square = dot(e, e), sum = w[k] + next.w;
    bool is = goes_on(lane * K + k) && sum > 0.0 && square > 0.0;
    float per_l = inversesqrt(square), l = square * per_l;
    direction[k] = is ? e * per_l : vec3(0.0);
    float soft = max(alpha, regularised(smallest, kElastic, l / rest) * max(w[k], next.w));
    link_diagonal[k] = is ? sum + soft : 1.0;
    link_right[k] = is ? rest - l : 0.0;
    link_length[k] = l;
    if (kTension && is) link_right[k] += soft * pull[k] * l;
  }
  exchange(vec4(direction[K - 1u], 0.0), 1u, below, none);
  exchange(vec4(direction[0], kCorrectsSplitting ? along_diagonal(0u) : 0.0), 1u, none, above);
  [[unroll]] for (uint k = 0u; kCorrectsSplitting && k < K; ++k) {
    float next = above.w;
    if (k + 1u < K) next = along_diagonal(k + 1u);
    if (direction[k] != vec3(0.0)) link_right[k] -= creep[k] + next - along_diagonal(k);
  }
  direction_below = lane > 0u ? below.xyz : vec3(0.0);
  vec3 direction_above = lane + 1u < LANES ? above.xyz : vec3(0.0);
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    vec3 before = direction_below, next = direction_above;
    float w_next = w_above;
    if (k > 0u) before = direction[k - 1u];
    if (k + 1u < K) { next = direction[k + 1u]; w_next = w[k + 1u]; }
    link_lower[k] = -w[k] * dot(before, direction[k]);
    link_upper[k] = -w_next * dot(direction[k], next);
  }
}

#include "xpbd/lines/tension.glsl"

/// Records the links' total multipliers. With implicit tension the solve has started at -pull * length.
void record_link_multipliers(float lambda_below) {
  float lambda[K];
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    lambda[k] = link_right[k];
    if (kTension) lambda[k] -= pull[k] * link_length[k];
  }
  if (kTension) {
    vec4 below, none;
    exchange(vec4(lambda[K - 1u], 0.0, 0.0, 0.0), 1u, below, none);
    lambda_below = lane > 0u ? below.x : 0.0;
  }
  record_multipliers(compliance(), lambda, lambda_below);
}

void stretch() {
  float smallest = 0.0;  // minimum ratio of alpha to inverse mass
  if ((FEATURES & LINES_REGULARISED) != 0u && chain < chain_count())
    smallest = regularisation[colour * max(COLUMNS, ROWS) + chain];
  if (kCorrectsSplitting) load_creep();
  if (kTension) turn_by_tension(smallest);
  link_equations(smallest);
  float lambda_below;
  solve_links(32u, lambda_below);
  if (kCorrectsSplitting) record_link_multipliers(lambda_below);
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    vec3 step = lambda_below * direction_below;
    if (k > 0u) step = link_right[k - 1u] * direction[k - 1u];
    move(k, w[k] * (step - link_right[k] * direction[k]));
  }
}

/// Bending along rows and columns: vector constraints C = x[i-1] - 2 x[i] + x[i+1] of the quadratic energy
/// (B w / 2 a^3) |C|^2 (Bergou et al. 2006 on a line), compliance a^3 / (B w), gradients 1, -2, 1.
void hinge_equations() {
  vec4 below, above, none;
  exchange(vec4(pos[K - 1u], w[K - 1u]), 1u, below, none);
  exchange(vec4(pos[0], w[0]), 1u, none, above);
  float alpha = (colour == 0u ? p.bend_u : p.bend_v) * border();
  uint n = chain_length(), first = lane * K;
  [[unroll]] for (uint r = 0u; r < BLOCKS; ++r) {
    vec2 diagonal, near_below, far_below, near_above, far_above;
    vec3 right[2];
    [[unroll]] for (uint h = 0u; h < 2u; ++h) {
      uint k = 2u * r + h, i = first + k;
      vec4 last = below, next = above;
      if (k > 0u) last = vec4(pos[k - 1u], w[k - 1u]);
      if (k + 1u < K) next = vec4(pos[k + 1u], w[k + 1u]);
      bool is = i >= 1u && on_chain(i + 1u) && last.w + w[k] + next.w > 0.0;
      // Two successive attached vertices are a clamp. The hinge there covers half a cell, so it is twice as stiff.
      float a = w[k] == 0.0 && (last.w == 0.0) != (next.w == 0.0) ? 0.5 * alpha : alpha;
      diagonal[h] = is ? last.w + 4.0 * w[k] + next.w + a : 1.0;
      near_below[h] = is && i >= 2u ? -2.0 * (last.w + w[k]) : 0.0;
      far_below[h] = is && i >= 3u ? last.w : 0.0;
      near_above[h] = is && i + 2u < n ? -2.0 * (w[k] + next.w) : 0.0;
      far_above[h] = is && i + 3u < n ? next.w : 0.0;
      right[h] = is ? 2.0 * pos[k] - last.xyz - next.xyz : vec3(0.0);
    }
    hinge_diagonal[r] = mat2(diagonal[0], near_below[1], near_above[0], diagonal[1]);
    hinge_lower[r] = mat2(far_below[0], 0.0, near_below[0], far_below[1]);
    hinge_upper[r] = mat2(far_above[0], near_above[1], 0.0, far_above[1]);
    hinge_right[r] =
        mat3x2(right[0].x, right[1].x, right[0].y, right[1].y, right[0].z, right[1].z);
  }
}

/// Solves the hinges of a row or column, and moves the vertices by the result.
void bend() {
  hinge_equations();
  mat3x2 block_below;
  solve_hinges(colour == 0u ? p.bend_rounds_u : p.bend_rounds_v, block_below);
  vec3 lambda[K];
  vec4 none, above;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint r = k / 2u, h = k % 2u;
    lambda[k] = vec3(hinge_right[r][0][h], hinge_right[r][1][h], hinge_right[r][2][h]);
  }
  exchange(vec4(lambda[0], 0.0), 1u, none, above);
  vec3 lambda_below = vec3(block_below[0].y, block_below[1].y, block_below[2].y),
       lambda_above = lane + 1u < LANES ? above.xyz : vec3(0.0);
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    vec3 last = lambda_below, next = lambda_above;
    if (k > 0u) last = lambda[k - 1u];
    if (k + 1u < K) next = lambda[k + 1u];
    move(k, w[k] * (last - 2.0 * lambda[k] + next));
  }
}
