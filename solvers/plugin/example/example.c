/* Extended position-based dynamics on one CPU core, complete: small steps, one pass over the constraints each
 * (Macklin et al., Small Steps in Physics Simulation, 2019), bending by the isometric Laplacian (Bergou et al. 2006). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clothbench_plugin.h"

typedef struct {
  int substeps;
  const ClothbenchScene* scene;
  double *x, *v, *before, *weight; /* weight: 1 / mass, 0 where pinned */
  ClothbenchStage stages[3];
  uint32_t stage_count;
} Solver;

static void* create(const double* settings) {
  Solver* s = calloc(1, sizeof *s);
  if (s) s->substeps = (int)settings[0];
  return s;
}

static void release(Solver* s) { free(s->x); s->x = NULL; }
static void destroy(void* self) { release(self); free(self); }

static void reset(void* self) {
  Solver* s = self;
  const ClothbenchScene* c = s->scene;
  memcpy(s->x, c->position_m, 3 * c->vertex_count * sizeof(double));
  memcpy(s->v, c->velocity_m_per_s, 3 * c->vertex_count * sizeof(double));
  for (uint32_t k = 0; k < c->vertex_count; ++k) s->weight[k] = 1 / c->mass_kg[k];
  for (uint32_t k = 0; k < c->pin_count; ++k) {
    s->weight[c->pins[k]] = 0;
    memset(s->v + 3 * c->pins[k], 0, 3 * sizeof(double));
  }
}

/* Says what will run: nothing that the scene does not need. */
static void add_stage(Solver* s, const char* name, uint32_t serves, uint32_t always) {
  if (serves & s->scene->needs || always) s->stages[s->stage_count++] = (ClothbenchStage){name, serves & s->scene->needs, 0, NAN, NAN};
}

static int32_t load(void* self, const ClothbenchScene* scene) {
  Solver* s = self;
  const uint32_t n = scene->vertex_count;
  release(s);
  s->scene = scene;
  s->x = malloc(10 * n * sizeof(double));
  if (!s->x) return 1;
  s->v = s->x + 3 * n;
  s->before = s->v + 3 * n;
  s->weight = s->before + 3 * n;
  s->stage_count = 0;
  add_stage(s, "integrate", CLOTHBENCH_DAMPING | CLOTHBENCH_PINS, 1);
  add_stage(s, "edges", CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR, 0);
  add_stage(s, "bending", CLOTHBENCH_BEND, 0);
  reset(s);
  return 0;
}

/* Distance constraints; a spring lattice with 3/4 Y along the grid and 3/8 Y along the diagonals is a sheet of stiffness Y
 * (square cells, Poisson's ratio 1/3). */
static void solve_edges(Solver* s, const ClothbenchEdge* edges, uint32_t count, double share, double h) {
  for (uint32_t k = 0; k < count; ++k) {
    const ClothbenchEdge* e = edges + k;
    double *a = s->x + 3 * e->a, *b = s->x + 3 * e->b, d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), wa = s->weight[e->a], wb = s->weight[e->b];
    const double compliance = e->along_m / (share * e->membrane_stiffness_N_per_m * e->across_m) / (h * h);
    if (!(length > 0) || wa + wb == 0) continue;
    const double move = (length - e->rest_m) / ((wa + wb + compliance) * length);
    for (int i = 0; i < 3; ++i) a[i] += wa * move * d[i], b[i] -= wb * move * d[i];
  }
}

/* E = B w / (2 l^3) |a - 2 m + b|^2 for a strip of width w, its vertices l apart. */
static void solve_bending(Solver* s, double h) {
  for (uint32_t k = 0; k < s->scene->skip_count; ++k) {
    const ClothbenchEdge* e = s->scene->skip_edges + k;
    const uint32_t middle = (e->a + e->b) / 2;
    double *a = s->x + 3 * e->a, *m = s->x + 3 * middle, *b = s->x + 3 * e->b;
    const double wa = s->weight[e->a], wm = s->weight[middle], wb = s->weight[e->b];
    const double compliance = pow(e->along_m, 3) / (s->scene->bending_rigidity_N_m * e->across_m) / (h * h);
    for (int i = 0; i < 3; ++i) {
      const double move = (a[i] - 2 * m[i] + b[i]) / (wa + 4 * wm + wb + compliance);
      a[i] -= wa * move, m[i] += 2 * wm * move, b[i] -= wb * move;
    }
  }
}

static int32_t step(void* self, const ClothbenchFrame* frame) {
  Solver* s = self;
  const ClothbenchScene* c = s->scene;
  const double h = frame->dt_s / s->substeps, kept = exp(-c->damping_per_s * h);
  for (int k = 0; k < s->substeps; ++k) {
    memcpy(s->before, s->x, 3 * c->vertex_count * sizeof(double));
    for (uint32_t i = 0; i < 3 * c->vertex_count; ++i)
      if (s->weight[i / 3] > 0) s->x[i] += h * (s->v[i] = kept * s->v[i] + h * c->gravity_m_per_s2[i % 3]);
    solve_edges(s, c->structural_edges, c->structural_count, 0.75, h);
    solve_edges(s, c->shear_edges, c->shear_count, 0.375, h);
    solve_bending(s, h);
    for (uint32_t i = 0; i < 3 * c->vertex_count; ++i) s->v[i] = (s->x[i] - s->before[i]) / h;
  }
  for (uint32_t i = 0; i < 3 * c->vertex_count; ++i)
    if (!isfinite(s->x[i])) return CLOTHBENCH_NOT_FINITE;
  return CLOTHBENCH_OK;
}

static void read_state(void* self, double* position, double* velocity) {
  const Solver* s = self;
  memcpy(position, s->x, 3 * s->scene->vertex_count * sizeof(double));
  memcpy(velocity, s->v, 3 * s->scene->vertex_count * sizeof(double));
}

static const ClothbenchStage* stages(void* self, uint32_t* count) { *count = ((Solver*)self)->stage_count; return ((Solver*)self)->stages; }

static int32_t restart(void* self, const double* position, const double* velocity) {
  Solver* s = self;
  memcpy(s->x, position, 3 * s->scene->vertex_count * sizeof(double));
  memcpy(s->v, velocity, 3 * s->scene->vertex_count * sizeof(double));
  return 1;
}

/* What `step` makes of a body that nothing holds. */
static double free_fall(const double* settings, double dt, double gravity, double velocity, double damping, int32_t frames) {
  const int substeps = (int)settings[0];
  const double h = dt / substeps, kept = exp(-damping * h);
  double way = 0;
  for (int k = 0; k < substeps * frames; ++k) way += h * (velocity = kept * velocity + h * gravity);
  return way;
}

static const ClothbenchSetting settings[] = {{"substeps", "steps a frame", 20, 1}};

const ClothbenchPlugin* clothbench_plugin(void) {
  static const ClothbenchPlugin plugin = {
      CLOTHBENCH_PLUGIN_HEADER, "example-xpbd", "XPBD with small steps on one core, the example of a plugin", "1", "float64",
      CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR | CLOTHBENCH_BEND | CLOTHBENCH_DAMPING | CLOTHBENCH_PINS, 0, 1, 1, settings,
      create, destroy, load, reset, step, read_state, stages, NULL, restart, free_fall, NULL, NULL};
  return &plugin;
}
