/* A plugin with one fault, selected by a macro FAULT_… when it is compiled or by $FAULT at run time: crash:N, hang:N,
 * exit:N, nan:N (in the Nth step of a solver), load (refuses), create (crashes). With $CHATTER it prints on standard
 * output wherever it can. Without a fault its cloth stands still. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clothbench_plugin.h"

typedef struct {
  const ClothbenchScene* scene;
  int steps;
  ClothbenchStage stage;
  double x[]; /* positions */
} Solver;

static void chatter(void) {
  if (getenv("CHATTER")) printf("{\"plugin\": \"prints\"}\n");
}

__attribute__((constructor)) static void chatter_when_loaded(void) { chatter(); }
__attribute__((destructor)) static void chatter_when_unloaded(void) { chatter(); }

static int32_t restart(void* self, const ClothbenchRestart* at) {
  Solver* s = self;
  memcpy(s->x, s->scene->position_m, 3 * s->scene->vertex_count * sizeof(double));
  return at->index < 0;
}

static void* create(const double* settings, const ClothbenchScene* scene, const char** why) {
  (void)settings;
  const char* fault = getenv("FAULT");
  if (fault && strcmp(fault, "load") == 0) return *why = "it was asked to fail", NULL;
  if (fault && strcmp(fault, "create") == 0) *(volatile int*)8 = 1;
  Solver* s = calloc(1, sizeof *s + 3 * scene->vertex_count * sizeof(double));
  s->scene = scene;
  s->stage = (ClothbenchStage){"stand still", 0, 0, NAN, NAN};
#ifdef FAULT_LATE
  s->stage.serves = scene->needs;
#endif
  return restart(s, &(ClothbenchRestart){.index = -1}), s;
}

/* FAULT_LATE: attached vertices follow their hands only for 12 frames. */
static void follow(Solver* s, const ClothbenchFrame* frame) {
#ifdef FAULT_LATE
  if (frame->grip_position_m == NULL || frame->index >= 12) return;
  for (uint32_t k = 0; k < s->scene->grip_count; ++k)
    memcpy(s->x + 3 * s->scene->grips[k], frame->grip_position_m + 3 * k, 3 * sizeof(double));
#else
  (void)s, (void)frame;
#endif
}

static int32_t step(void* self, const ClothbenchFrame* frame) {
  chatter();
  follow(self, frame);
  const char* fault = getenv("FAULT");
  const char* at = fault ? strchr(fault, ':') : NULL;
  if (!at || ++((Solver*)self)->steps != atoi(at + 1)) return CLOTHBENCH_OK;
  if (strncmp(fault, "crash", 5) == 0) *(volatile int*)8 = 1;
  if (strncmp(fault, "exit", 4) == 0) exit(0);
  while (strncmp(fault, "hang", 4) == 0) {
  }
  return CLOTHBENCH_NOT_FINITE;
}

static void read_state(void* self, double* position, double* velocity) {
  const ClothbenchScene* c = ((Solver*)self)->scene;
  memcpy(position, ((Solver*)self)->x, 3 * c->vertex_count * sizeof(double));
  memset(velocity, 0, 3 * c->vertex_count * sizeof(double));
}

static const ClothbenchStage* stages(void* self, uint32_t* count) {
  *count = 1;
  return &((Solver*)self)->stage;
}

/* A cloth that stands still does not fall. */
static double free_fall(const double* settings, double dt, double gravity, double velocity, double damping, int32_t frames) {
  (void)settings, (void)dt, (void)gravity, (void)velocity, (void)damping, (void)frames;
  return 0;
}

/* 3 cm for the first collider, and the scene's margin for the others. */
static double contact_margin(void* self, uint32_t collider) {
  (void)self;
  return collider == 0 ? 0.03 : NAN;
}

#ifdef FAULT_CRASHES_ON_LOAD
__attribute__((constructor)) static void at_load(void) { *(volatile int*)8 = 1; }
#endif
#ifdef FAULT_ENDS_ON_LOAD
__attribute__((constructor)) static void at_load(void) { _Exit(7); }
#endif

#ifdef FAULT_NO_SYMBOL
const ClothbenchPlugin* another_name(void) {
#else
const ClothbenchPlugin* clothbench_plugin(void) {
#endif
  static ClothbenchPlugin plugin = {
      CLOTHBENCH_PLUGIN_HEADER, "faulty", "wrong on purpose", "1", "float64", 0, (1u << 19) - 1, 1, 0, NULL,
      create, free, restart, step, read_state, stages, free_fall, NULL, contact_margin};
#ifdef FAULT_VERSION
  plugin.version = 99;
#endif
#ifdef FAULT_SCENE_SIZE
  plugin.scene_size += 8;
#endif
#ifdef FAULT_EDGE_SIZE
  plugin.edge_size -= 8;
#endif
#ifdef FAULT_NO_STEP
  plugin.step = NULL;
#endif
#ifdef FAULT_STRETCHES
  plugin.name = "stretches", plugin.supports = plugin.ignores, plugin.ignores = 0;
#endif
#ifdef FAULT_LATE
  plugin.name = "late", plugin.supports = plugin.ignores, plugin.ignores = 0;
#endif
#ifdef FAULT_NAME
  plugin.name = "ballistic";
#endif
#ifdef FAULT_BITS
  plugin.supports = 1u << 25;
#endif
  return &plugin;
}
