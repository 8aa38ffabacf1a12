/* Extended position-based dynamics on one CPU core, in small steps, each with one pass over the constraints
 * (Macklin et al., Small Steps in Physics Simulation, 2019); bending by an isometric Laplacian (Bergou et al. 2006). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clothbench_plugin.h"

typedef struct {
  const ClothbenchScene* scene;
  int substeps, stage_count;
  ClothbenchStage stages[3];
  double *x, *v, *before, *weight, memory[]; /* weight: 1 / mass, 0 where pinned */
} Solver;

/* Adds a stage if the scene needs a feature that it serves, or always. */
static void add_stage(Solver* s, const char* name, uint32_t serves, int always) {
  const uint32_t needed = serves & s->scene->needs;
  if (needed || always) s->stages[s->stage_count++] = (ClothbenchStage){name, needed, 0, NAN, NAN};
}

static const ClothbenchStage* stages(void* self, uint32_t* count) {
  return *count = (uint32_t)((Solver*)self)->stage_count, ((Solver*)self)->stages;
}

static int32_t restart(void* self, const ClothbenchRestart* at) {
  Solver* s = self;
  memcpy(s->x, at->position_m, 3 * s->scene->vertex_count * sizeof(double));
  memcpy(s->v, at->velocity_m_per_s, 3 * s->scene->vertex_count * sizeof(double));
  return 1;
}

static void read_state(void* self, double* position, double* velocity) {
  const Solver* s = self;
  memcpy(position, s->x, 3 * s->scene->vertex_count * sizeof(double));
  memcpy(velocity, s->v, 3 * s->scene->vertex_count * sizeof(double));
}

static void* create(const double* settings, const ClothbenchScene* scene, const char** why) {
  const uint32_t n = scene->vertex_count;
  Solver* s = calloc(1, sizeof *s + 10 * n * sizeof(double));
  if (!s) return *why = "out of memory", NULL;
  s->substeps = (int)settings[0], s->scene = scene;
  s->x = s->memory, s->v = s->x + 3 * n, s->before = s->v + 3 * n, s->weight = s->before + 3 * n;
  const ClothbenchRestart start = {.index = -1, .position_m = scene->position_m, .velocity_m_per_s = scene->velocity_m_per_s};
  restart(s, &start);
  for (uint32_t k = 0; k < n; ++k) s->weight[k] = 1 / scene->mass_kg[k];
  for (uint32_t k = 0; k < scene->pin_count; ++k) s->weight[scene->pins[k]] = 0;
  add_stage(s, "integrate", CLOTHBENCH_DAMPING | CLOTHBENCH_PINS, 1);
  add_stage(s, "edges", CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR, 0);
  add_stage(s, "bending", CLOTHBENCH_BEND, 0);
  return s;
}

/* Moves d = a - b of an edge towards its rest length, or d = a - 2 middle + b of a fold towards 0. A sheet of stiffness
 * Y and Poisson's ratio 1/3 is a lattice of springs, with `share` 3/4 along the grid and 3/8 along the diagonals of
 * square cells; a strip of width w with vertices l apart has the bending energy B w / (2 l^3) |d|^2. */
static void hold(Solver* s, const ClothbenchEdge* e, int fold, double share, double h) {
  const double bending = s->scene->bending_rigidity_N_m / (e->along_m * e->along_m);
  const double modulus = fold ? bending : share * e->membrane_stiffness_N_per_m;
  const uint32_t vertex[3] = {e->a, e->b, (e->a + e->b) / 2};
  const double sign[3] = {1, fold ? 1 : -1, fold ? -2 : 0};
  double d[3] = {0, 0, 0}, give = e->along_m / (modulus * e->across_m * h * h);
  for (int k = 0; k < 3; ++k) {
    give += sign[k] * sign[k] * s->weight[vertex[k]];
    for (int i = 0; i < 3; ++i) d[i] += sign[k] * s->x[3 * vertex[k] + i];
  }
  const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (!(length > 0 && give > 0)) return;
  const double move = (1 - (fold ? 0 : e->rest_m) / length) / give;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) s->x[3 * vertex[k] + i] -= move * s->weight[vertex[k]] * sign[k] * d[i];
}

static int32_t step(void* self, const ClothbenchFrame* frame) {
  Solver* s = self;
  const ClothbenchScene* c = s->scene;
  const uint32_t n = 3 * c->vertex_count;
  const double h = frame->dt_s / s->substeps, kept = exp(-c->damping_per_s * h);
  for (int k = 0; k < s->substeps; ++k) {
    memcpy(s->before, s->x, n * sizeof(double));
    for (uint32_t i = 0; i < n; ++i)
      if (s->weight[i / 3] > 0) s->x[i] += h * (kept * s->v[i] + h * c->gravity_m_per_s2[i % 3]);
    for (uint32_t i = 0; i < c->structural_count; ++i) hold(s, c->structural_edges + i, 0, 0.75, h);
    for (uint32_t i = 0; i < c->shear_count; ++i) hold(s, c->shear_edges + i, 0, 0.375, h);
    for (uint32_t i = 0; i < c->skip_count; ++i) hold(s, c->skip_edges + i, 1, 1, h);
    for (uint32_t i = 0; i < n; ++i) s->v[i] = (s->x[i] - s->before[i]) / h;
  }
  for (uint32_t i = 0; i < n; ++i)
    if (!isfinite(s->x[i])) return CLOTHBENCH_NOT_FINITE;
  return CLOTHBENCH_OK;
}

const ClothbenchPlugin* clothbench_plugin(void) {
  static const ClothbenchSetting settings[] = {{"substeps", "steps per frame", 20, 1}};
  static const ClothbenchPlugin plugin = {
      CLOTHBENCH_PLUGIN_HEADER,
      .name = "example-xpbd",
      .summary = "XPBD with small steps on one core: an example",
      .solver_version = "2",
      .precision = "float64",
      .supports = CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR | CLOTHBENCH_BEND | CLOTHBENCH_DAMPING | CLOTHBENCH_PINS,
      .time_order = 1,
      .setting_count = 1,
      .settings = settings,
      .create = create,
      .destroy = free,
      .restart = restart,
      .step = step,
      .read_state = read_state,
      .stages = stages,
  };
  return &plugin;
}
