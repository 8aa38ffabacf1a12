// Splitting-error correction (xpbd/time/README.md). Diagonals are solved first, for the length that they will have once
// columns and rows have moved the vertices. A second-order low-pass filter predicts these displacements from the last
// substeps. A part of each link's compliance acts delayed (creep), because the shift would excite oscillations.
layout(std430, binding = BIND_SHIFTS) coherent buffer Shifts { vec4 shifts[]; };  // `shift` divided by h'^2
layout(std430, binding = BIND_LINK_CREEP) buffer LinkCreep { float link_creep[]; };
const float kMaxRate = 0.04, kRatePerFrame = 0.2;  // filter rate: maximum per substep, and sum over a frame
const float kMaxShift = 0.25;                      // as a fraction of a cell
const float kShiftFraction = 0.995;  // applied fraction of a shift; at 1 some flat sheets drift within a minute
vec4 shift[K];    // displacement along rows (x) and columns (y) [m], and the filter's first stage (z, w)
float creep[K];  // elongation of links by delayed compliance [m]

float filter_rate() { return min(kMaxRate, kRatePerFrame * p.substep_part); }

/// Fraction of a link's compliance that acts at once. The rest acts by creep, so the state at rest is the same.
float at_once() {
  float waves = 4.0 / 3.0 * p.inverse_mass / p.alpha_u;  // h'^2 Y / m: squared count of links that a wave crosses in h'
  float links = float(min(COLUMNS, ROWS) - 1u);
  return 1.0 / (1.0 + waves / (3.0 * waves + links * links / 7.0));
}

/// Length that the shift of the thread's vertex k adds along its diagonal.
float along_diagonal(uint k) {
  vec2 part = vec2(colour == 2u ? p.rest_u : -p.rest_u, p.rest_v) / p.rest_d;
  return colour >= 2u ? kShiftFraction * dot(part, shift[k].xy) : 0.0;
}

uint creep_index(uint k) { return colour * COLUMNS * ROWS + index_of(vertex(lane * K + k)); }

void load_creep() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    creep[k] = 0.0;
    if (goes_on(lane * K + k)) creep[k] = link_creep[creep_index(k)];
  }
}

/// Updates creep and shifts after a solve. `lambda`: multipliers of the thread's links; `below`: of the previous link.
void record_multipliers(float alpha, float lambda[K], float below) {
  float rate = filter_rate();
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    if (goes_on(lane * K + k))
      link_creep[creep_index(k)] = creep[k] + rate * ((1.0 - at_once()) * alpha * lambda[k] - creep[k]);
    float before = below;
    if (k > 0u) before = lambda[k - 1u];
    float moved = w[k] * (before - lambda[k]), largest = kMaxShift * (colour == 0u ? p.rest_u : p.rest_v);
    if (colour == 0u) {
      shift[k].x = clamp(shift[k].x + rate * (shift[k].z - shift[k].x), -largest, largest);
      shift[k].z += rate * (moved - shift[k].z);
    } else if (colour == 1u) {
      shift[k].y = clamp(shift[k].y + rate * (shift[k].w - shift[k].y), -largest, largest);
      shift[k].w += rate * (moved - shift[k].w);
    }
  }
}
