/* A plugin that uses the whole interface and checks what it is given: its cloth flies on without
 * forces. What it finds wrong fails `create` or a step. $FAULT names what is wrong with its own values: unsupported,
 * driver, properties, buffers, in_flight, device_time, stage_time; or that it refuses a scene: refuse. $LOG: a file for
 * the calls that a test counts. */
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
  int times_stages, frame, begun; /* begun: frames in flight */
  double *x, *v, *capsule, *grip; /* capsule: the first 7 numbers of each collider at the end of the last frame */
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

static double length(const double* a, const double* b, int dimensions) {
  double sum = 0;
  for (int k = 0; k < dimensions; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sqrt(sum);
}

/* Whether the side from vertex k of triangle t is one of triangle u's, and u names t there. */
static int shares(const ClothbenchScene* c, uint32_t t, uint32_t k, uint32_t u) {
  const uint32_t a = c->triangles[3 * t + k], b = c->triangles[3 * t + (k + 1) % 3];
  for (uint32_t i = 0; i < 3; ++i) {
    const uint32_t p = c->triangles[3 * u + i], q = c->triangles[3 * u + (i + 1) % 3];
    if (((p == a && q == b) || (p == b && q == a)) && c->triangle_neighbours[3 * u + i] == t) return 1;
  }
  return 0;
}

static const char* wrong_shape(const ClothbenchScene* c) {
  const int mesh = (c->needs & CLOTHBENCH_CLOTH_MESH) != 0;
  if ((c->pattern_m == NULL) != mesh) return "pattern_m: expected for a grid, and only there";
  for (uint32_t k = 0; k < c->structural_count; ++k) {
    const ClothbenchEdge* e = c->structural_edges + k;
    if (!near(length(c->rest_position_m + 3 * e->a, c->rest_position_m + 3 * e->b, 3), e->rest_m))
      return "rest_position_m: an edge has another length";
    if (!mesh && !near(length(c->pattern_m + 2 * e->a, c->pattern_m + 2 * e->b, 2), e->rest_m))
      return "pattern_m: an edge has another length";
  }
  uint32_t border = 0;
  for (uint32_t t = 0; t < c->triangle_count; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t u = c->triangle_neighbours[3 * t + k];
      if (u == CLOTHBENCH_NONE)
        ++border;
      else if (u >= c->triangle_count || !shares(c, t, k, u))
        return "triangle_neighbours: not a neighbour";
    }
  if (!mesh && border != 2 * (c->columns - 1 + c->rows - 1)) return "triangle_neighbours: another border";
  return NULL;
}

/* On square cells: 3/4 of Y b / a along the grid, with b halved on the border, and 3/8 of Y on diagonals. */
static const char* wrong_springs(const ClothbenchScene* c) {
  if (!(c->needs & CLOTHBENCH_SHEAR) || (c->needs & CLOTHBENCH_CLOTH_MESH)) return NULL;
  if (!near(c->poisson_ratio, 1.0 / 3)) return "poisson_ratio: expected 1/3";
  if (!near(c->width_m / (c->columns - 1), c->height_m / (c->rows - 1)) || (c->needs & CLOTHBENCH_UNEVEN_GRID))
    return NULL;
  for (uint32_t k = 0; k < c->structural_count; ++k) {
    const ClothbenchEdge* e = c->structural_edges + k;
    const double expected = 0.75 * e->membrane_stiffness_N_per_m * e->across_m / e->along_m;
    if (!isinf(expected) && !near(c->structural_spring_N_per_m[k], expected)) return "structural_spring_N_per_m";
    if (isinf(expected) != isinf(c->structural_spring_N_per_m[k]))
      return "structural_spring_N_per_m: expected infinity";
  }
  for (uint32_t k = 0; k < c->shear_count; ++k) {
    const double expected = 0.375 * c->shear_edges[k].membrane_stiffness_N_per_m;
    if (!isinf(expected) && !near(c->shear_spring_N_per_m[k], expected)) return "shear_spring_N_per_m";
  }
  return NULL;
}

static const char* unsupported(const double* settings, const ClothbenchScene* scene) {
  (void)settings;
  if (fault("unsupported")) return "";
  if (fault("refuse")) return "it was asked to refuse";
  return scene->columns == 13 ? "13 columns are too many" : NULL;
}

static void keep_poses(Solver* s, const ClothbenchPose* poses, const double* grips) {
  for (uint32_t k = 0; k < s->scene->collider_count; ++k) {
    const double* from = poses[k].capsules ? poses[k].capsules : poses[k].vertices_m;
    if (from) memcpy(s->capsule + 7 * k, from, (poses[k].capsules ? 7 : 3) * sizeof(double));
  }
  if (grips) memcpy(s->grip, grips, 3 * s->scene->grip_count * sizeof(double));
}

static void at_start(Solver* s) {
  keep_poses(s, s->scene->poses, NULL);
  s->frame = -1;
}

static void* create(const double* settings, const ClothbenchScene* scene, const char** why) {
  if ((*why = wrong_shape(scene)) || (*why = wrong_springs(scene))) return NULL;
  const size_t n = 3 * scene->vertex_count * sizeof(double);
  Solver* s = calloc(1, sizeof *s);
  s->scene = scene, s->times_stages = settings[0] != 0;
  s->stage = (ClothbenchStage){"fly", 0, 1, 48.0 * scene->vertex_count, 24.0 * scene->vertex_count};
  s->x = malloc(n), s->v = malloc(n);
  s->capsule = calloc(7 * scene->collider_count + 1, sizeof(double));
  s->grip = calloc(3 * scene->grip_count + 1, sizeof(double));
  memcpy(s->x, scene->position_m, n), memcpy(s->v, scene->velocity_m_per_s, n);
  at_start(s);
  note("create stage_times=%d\n", s->times_stages);
  return s;
}

static void destroy(void* self) {
  Solver* s = self;
  free(s->x), free(s->v), free(s->capsule), free(s->grip), free(s);
}

static int32_t restart_at(void* self, const ClothbenchRestart* at) {
  Solver* s = self;
  const size_t n = 3 * s->scene->vertex_count * sizeof(double);
  memcpy(s->x, at->position_m, n), memcpy(s->v, at->velocity_m_per_s, n);
  keep_poses(s, at->poses, at->grip_position_m);
  s->frame = at->index;
  if (at->index >= 0) note("restart index=%d time=%.6f\n", (int)at->index, at->time_s);
  return 1;
}

/* What was the end of the last frame must be this one's beginning. */
static int follows(const Solver* s, const ClothbenchFrame* f) {
  const ClothbenchScene* c = s->scene;
  if (f->index != s->frame + 1) return 0;
  if ((f->poses_before == NULL) != (c->collider_count == 0)) return 0;
  for (uint32_t k = 0; k < c->collider_count; ++k) {
    const ClothbenchPose* p = f->poses_before + k;
    const double* from = p->capsules ? p->capsules : p->vertices_m;
    if (from && memcmp(s->capsule + 7 * k, from, (p->capsules ? 7 : 3) * sizeof(double)) != 0) return 0;
  }
  if ((f->grip_position_m == NULL) != (f->grip_position_before_m == NULL)) return 0;
  if ((f->grip_held == NULL) != (f->grip_held_before == NULL)) return 0;
  return f->grip_position_m == NULL || f->index == 0 ||
         memcmp(s->grip, f->grip_position_before_m, 3 * c->grip_count * sizeof(double)) == 0;
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
  keep_poses(s, f->poses, f->grip_position_m);
  s->frame = f->index;
  return CLOTHBENCH_OK;
}

static void reset(void* self) {
  Solver* s = self;
  const size_t n = 3 * s->scene->vertex_count * sizeof(double);
  memcpy(s->x, s->scene->position_m, n), memcpy(s->v, s->scene->velocity_m_per_s, n);
  at_start(s);
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

static const ClothbenchBuffer* buffers(void* self, uint32_t* count) {
  static ClothbenchBuffer all[2];
  const uint64_t n = 24 * (uint64_t)((Solver*)self)->scene->vertex_count;
  all[0] = (ClothbenchBuffer){"positions", n, 1},
  all[1] = (ClothbenchBuffer){fault("buffers") ? NULL : "velocities", n, 0};
  return *count = 2, all;
}

static double device_s(void* self) { return (void)self, fault("device_time") ? -1 : 1e-4; }

static void stage_device_s(void* self, double* seconds) {
  seconds[0] = fault("stage_time") ? -1 : ((Solver*)self)->times_stages ? 5e-5 : 1;
}

static int32_t frames_in_flight(void* self) { return (void)self, fault("in_flight") ? 0 : 2; }

static int32_t submit(void* self, const ClothbenchFrame* frame) {
  Solver* s = self;
  if (s->begun < 2) ++s->begun;
  return step(self, frame);
}

static int32_t finish(void* self) {
  note("finish in_flight=%d\n", ((Solver*)self)->begun);
  ((Solver*)self)->begun = 0;
  return CLOTHBENCH_OK;
}

CLOTHBENCH_PLUGIN_EXPORT const ClothbenchPlugin* clothbench_plugin(void) {
  static const ClothbenchSetting settings[] = {{"stage_times", "times of stages too", 0, 1}};
  static ClothbenchPlugin plugin = {CLOTHBENCH_PLUGIN_HEADER, .name = "full", .summary = "uses the whole interface"};
  plugin.solver_version = "4", plugin.precision = "float64", plugin.time_order = 1;
  plugin.ignores = (1u << 21) - 1;
  plugin.setting_count = 1, plugin.settings = settings;
  plugin.create = create, plugin.destroy = destroy, plugin.step = step, plugin.read_state = read_state;
  plugin.stages = stages, plugin.reset = reset, plugin.free_fall_m = free_fall;
  plugin.unsupported = unsupported, plugin.restart_at = restart_at;
  plugin.device_info = device_info, plugin.buffers = buffers;
  plugin.device_s = device_s, plugin.stage_device_s = stage_device_s;
  plugin.frames_in_flight = frames_in_flight, plugin.submit = submit, plugin.finish = finish;
  plugin.engine = "Engine";
#ifdef FAULT_NO_FINISH
  plugin.finish = NULL;
#endif
#ifdef FAULT_NO_STAGE_SETTING
  plugin.setting_count = 0;
#endif
#ifdef FAULT_TOO_SMALL
  plugin.plugin_size = offsetof(ClothbenchPlugin, finish);
#endif
  return &plugin;
}
