/* A plugin that uses the whole interface and checks its input: wrong input fails `create` or a step. Its cloth moves on
 * uniformly, without forces. $FAULT selects one of its own values to be wrong (unsupported, driver, properties,
 * device_time, count_name, count_value, count_missing), or makes it refuse a scene (refuse). $LOG: a file for the calls
 * that a test counts. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clothbench_plugin.h"

typedef struct {
  const ClothbenchScene* scene;
  ClothbenchStage stage;
  int frame;
  double *x, *v, *capsule; /* capsule: the first 7 numbers of each collider at the end of the last frame */
} Solver;

static int fault(const char* name) {
  const char* given = getenv("FAULT");
  return given != NULL && strcmp(given, name) == 0;
}

static void note(const char* format, ...) {
  FILE* out = getenv("LOG") ? fopen(getenv("LOG"), "a") : NULL;
  if (!out) return;
  va_list words;
  va_start(words, format);
  vfprintf(out, format, words);
  va_end(words);
  fclose(out);
}

static int near(double a, double b) { return fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b)) + 1e-12; }

static double length(const double* a, const double* b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sqrt(sum);
}

static const char* wrong_shape(const ClothbenchScene* c) {
  for (uint32_t k = 0; k < c->structural_count; ++k) {
    const ClothbenchEdge* e = c->structural_edges + k;
    if (!near(length(c->rest_position_m + 3 * e->a, c->rest_position_m + 3 * e->b), e->rest_m))
      return "rest_position_m: an edge has another length";
  }
  return NULL;
}

/* Expected on square cells: 3/4 Y b / a for edges of the grid, with b halved on the border, and 3/8 Y for diagonals. */
static const char* wrong_springs(const ClothbenchScene* c) {
  if (!(c->needs & CLOTHBENCH_SHEAR) || (c->needs & CLOTHBENCH_CLOTH_MESH)) return NULL;
  if (!near(c->width_m / (c->columns - 1), c->height_m / (c->rows - 1)) || (c->needs & CLOTHBENCH_UNEVEN_GRID))
    return NULL;
  for (uint32_t k = 0; k < c->structural_count; ++k) {
    const ClothbenchEdge* e = c->structural_edges + k;
    const double expected = 0.75 * e->membrane_stiffness_N_per_m * e->across_m / e->along_m;
    if (!isinf(expected) && !near(e->spring_N_per_m, expected)) return "spring_N_per_m of a structural edge";
    if (isinf(expected) != isinf(e->spring_N_per_m)) return "spring_N_per_m: expected infinity";
  }
  for (uint32_t k = 0; k < c->shear_count; ++k) {
    const double expected = 0.375 * c->shear_edges[k].membrane_stiffness_N_per_m;
    if (!isinf(expected) && !near(c->shear_edges[k].spring_N_per_m, expected)) return "spring_N_per_m of a shear edge";
  }
  return NULL;
}

static const char* unsupported(const double* settings, const ClothbenchScene* scene) {
  (void)settings;
  if (fault("unsupported")) return "";
  if (fault("refuse")) return "it was asked to refuse";
  return scene->columns == 13 ? "13 columns are too many" : NULL;
}

static void keep_poses(Solver* s, const ClothbenchPose* poses) {
  for (uint32_t k = 0; k < s->scene->collider_count; ++k) {
    const double* from = poses[k].capsules ? poses[k].capsules : poses[k].vertices_m;
    if (from) memcpy(s->capsule + 7 * k, from, (poses[k].capsules ? 7 : 3) * sizeof(double));
  }
}

static void* create(const double* settings, const ClothbenchScene* scene, const char** why) {
  (void)settings;
  if ((*why = wrong_shape(scene)) || (*why = wrong_springs(scene))) return NULL;
  const size_t n = 3 * scene->vertex_count * sizeof(double);
  Solver* s = calloc(1, sizeof *s);
  s->scene = scene;
  s->stage = (ClothbenchStage){"fly", 0, 1, 48.0 * scene->vertex_count, 24.0 * scene->vertex_count};
  s->x = malloc(n), s->v = malloc(n);
  s->capsule = calloc(7 * scene->collider_count + 1, sizeof(double));
  memcpy(s->x, scene->position_m, n), memcpy(s->v, scene->velocity_m_per_s, n);
  keep_poses(s, scene->poses);
  s->frame = -1;
  return s;
}

static void destroy(void* self) {
  Solver* s = self;
  free(s->x), free(s->v), free(s->capsule), free(s);
}

static int32_t restart(void* self, const ClothbenchRestart* at) {
  Solver* s = self;
  const size_t n = 3 * s->scene->vertex_count * sizeof(double);
  memcpy(s->x, at->position_m, n), memcpy(s->v, at->velocity_m_per_s, n);
  keep_poses(s, at->poses);
  s->frame = at->index;
  if (at->index >= 0) note("restart index=%d time=%.6f\n", (int)at->index, at->time_s);
  return 1;
}

/* Each frame must begin with the poses at the end of the frame before. */
static int follows(const Solver* s, const ClothbenchFrame* f) {
  const ClothbenchScene* c = s->scene;
  if (f->index != s->frame + 1) return 0;
  if ((f->poses_before == NULL) != (c->collider_count == 0)) return 0;
  for (uint32_t k = 0; k < c->collider_count; ++k) {
    const ClothbenchPose* p = f->poses_before + k;
    const double* from = p->capsules ? p->capsules : p->vertices_m;
    if (from && memcmp(s->capsule + 7 * k, from, (p->capsules ? 7 : 3) * sizeof(double)) != 0) return 0;
  }
  return 1;
}

static int32_t step(void* self, const ClothbenchFrame* f) {
  Solver* s = self;
  const ClothbenchScene* c = s->scene;
  if (!follows(s, f)) return CLOTHBENCH_DIVERGED;
  for (uint32_t k = 0; f->collider_teleports && k < c->collider_count; ++k)
    if (f->collider_teleports[k]) note("teleport frame=%d collider=%u\n", (int)f->index, k);
  for (uint32_t k = 0; f->grip_teleports && k < c->grip_count; ++k)
    if (f->grip_teleports[k]) note("teleport frame=%d grip=%u\n", (int)f->index, k);
  for (uint32_t i = 0; i < 3 * c->vertex_count; ++i) s->x[i] += f->dt_s * s->v[i];
  keep_poses(s, f->poses);
  s->frame = f->index;
  return CLOTHBENCH_OK;
}

static void read_state(void* self, double* position, double* velocity) {
  const Solver* s = self;
  const size_t n = 3 * s->scene->vertex_count * sizeof(double);
  memcpy(position, s->x, n), memcpy(velocity, s->v, n);
}

static const ClothbenchStage* stages(void* self, uint32_t* count) { return *count = 1, &((Solver*)self)->stage; }

static double free_fall(const double* settings, double dt, double gravity, double velocity, double damping,
                        int32_t frames) {
  (void)settings, (void)gravity, (void)damping;
  return frames * dt * velocity;
}

static void device_info(void* self, ClothbenchDevice* out) {
  (void)self;
  *out = (ClothbenchDevice){"Paper GPU", fault("driver") ? "" : "driver 7", "CUDA 1.0", 1, "{\"cores\": 3}"};
  if (fault("properties")) out->properties_json = "[3]";
}

static double device_s(void* self) { return (void)self, fault("device_time") ? -1 : 1e-4; }

static const ClothbenchCount* counts(void* self, uint32_t* count) {
  static ClothbenchCount all[2];
  const int32_t frame = ((Solver*)self)->frame;
  all[0] = (ClothbenchCount){fault("count_name") ? "Steps" : "steps", "steps so far", frame + 1};
  all[1] = (ClothbenchCount){"never", "what never happens", fault("count_value") ? NAN : 0};
  return *count = fault("count_missing") && frame > 1 ? 1 : 2, all;
}

CLOTHBENCH_PLUGIN_EXPORT const ClothbenchPlugin* clothbench_plugin(void) {
  static ClothbenchPlugin plugin = {CLOTHBENCH_PLUGIN_HEADER, .name = "full", .summary = "uses the whole interface"};
  plugin.solver_version = "4", plugin.precision = "float64", plugin.time_order = 1;
  plugin.ignores = (1u << 20) - 1;
  plugin.create = create, plugin.destroy = destroy, plugin.step = step, plugin.read_state = read_state;
  plugin.stages = stages, plugin.free_fall_m = free_fall;
  plugin.unsupported = unsupported, plugin.restart = restart;
  plugin.device_info = device_info,
  plugin.device_s = device_s;
  plugin.engine = "Engine", plugin.counts = counts;
#ifdef FAULT_TOO_SMALL
  plugin.plugin_size = offsetof(ClothbenchPlugin, engine);
#endif
  return &plugin;
}
