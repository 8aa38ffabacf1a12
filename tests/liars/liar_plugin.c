/* A solver that replays a stored motion, wrong or right: setting `motion` N is the file N.motion in the folder that
 * the environment variable CLOTHBENCH_LIARS names, as `write_motion` of motions.hpp writes it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clothbench_plugin.h"

typedef struct {
  const ClothbenchScene* scene;
  uint32_t frames, colliders, frame;
  double* contact_offset_m;
  float* position_m;
  ClothbenchStage stage;
} Liar;

static void destroy(void* self) {
  Liar* s = self;
  free(s->contact_offset_m);
  free(s->position_m);
  free(s);
}

static int read_file(Liar* s, FILE* in) {
  char magic[4];
  uint32_t counts[3];
  if (fread(magic, 1, 4, in) != 4 || memcmp(magic, "LIAR", 4) != 0 || fread(counts, 4, 3, in) != 3) return 0;
  if (counts[1] != s->scene->vertex_count || counts[0] == 0) return 0;
  const size_t numbers = (size_t)3 * counts[0] * counts[1];
  s->frames = counts[0], s->colliders = counts[2];
  s->contact_offset_m = malloc((counts[2] + 1) * sizeof(double));
  s->position_m = malloc(numbers * sizeof(float));
  return s->contact_offset_m && s->position_m && fread(s->contact_offset_m, 8, counts[2], in) == counts[2] &&
         fseek(in, 8L * (long)counts[0], SEEK_CUR) == 0 && fread(s->position_m, 4, numbers, in) == numbers;
}

static void* create(const double* settings, const ClothbenchScene* scene, const char** why) {
  char path[4096];
  const char* folder = getenv("CLOTHBENCH_LIARS");
  *why = "CLOTHBENCH_LIARS names no folder with a motion of this number and of this scene's vertices";
  if (!folder || snprintf(path, sizeof path, "%s/%d.motion", folder, (int)settings[0]) >= (int)sizeof path) return NULL;
  FILE* in = fopen(path, "rb");
  Liar* s = calloc(1, sizeof *s);
  if (in && s) {
    s->scene = scene;
    /* All that the scene needs, since the motion has it all. */
    s->stage = (ClothbenchStage){"replay", scene->needs, 0, NAN, NAN};
    if (read_file(s, in)) {
      fclose(in);
      return s;
    }
  }
  if (in) fclose(in);
  if (s) destroy(s);
  return NULL;
}

static int32_t restart(void* self, const ClothbenchRestart* at) {
  ((Liar*)self)->frame = 0;
  return at->index < 0;
}

static int32_t step(void* self, const ClothbenchFrame* frame) {
  ((Liar*)self)->frame = (uint32_t)frame->index + 1;
  return CLOTHBENCH_OK;
}

static const float* now(const Liar* s) {
  const uint32_t last = s->frames - 1;
  return s->position_m + (size_t)3 * s->scene->vertex_count * (s->frame < last ? s->frame : last);
}

static void read_state(void* self, double* position, double* velocity) {
  const Liar* s = self;
  for (uint32_t i = 0; i < 3 * s->scene->vertex_count; ++i) position[i] = now(s)[i], velocity[i] = 0;
}

static double contact_margin_m(void* self, uint32_t collider) {
  const Liar* s = self;
  return collider < s->colliders ? s->contact_offset_m[collider] : NAN;
}

static const ClothbenchStage* stages(void* self, uint32_t* count) { return *count = 1, &((Liar*)self)->stage; }

const ClothbenchPlugin* clothbench_plugin(void) {
  static const ClothbenchSetting settings[] = {{"motion", "number of the motion's file", 0, 1}};
  static const ClothbenchPlugin plugin = {
      CLOTHBENCH_PLUGIN_HEADER,
      .name = "liar",
      .summary = "replays a stored motion, right or wrong",
      .solver_version = "1",
      .precision = "float32",
      .supports = (CLOTHBENCH_CLOTH_MESH << 1) - 1,
      .time_order = 1,
      .setting_count = 1,
      .settings = settings,
      .create = create,
      .destroy = destroy,
      .restart = restart,
      .step = step,
      .read_state = read_state,
      .stages = stages,
      .contact_margin_m = contact_margin_m,
  };
  return &plugin;
}
