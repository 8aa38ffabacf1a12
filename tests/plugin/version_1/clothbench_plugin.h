/* Interface of a cloth solver in a shared library, for `clothbench … --solver plugin:path.so`. C99; needs no other
 * header of clothbench.
 *
 * The library exports one function, `clothbench_plugin`, which returns a description that stays valid. Units are SI.
 * Vectors are x y z with +y up. Positions and velocities of vertices are interleaved and ordered by rows of the grid:
 * vertex (i, j), the ith of row j, has index j * columns + i. Pointers in a scene are valid until `destroy`, those in a
 * frame until `step` returns. Calls come from one thread at a time. No exception or longjmp may cross them.
 *
 * Version 1. Structs that are passed singly (plugin, scene, frame) may grow at their end within a version; structs in
 * arrays never change. Both sides state the sizes that they were compiled with, and a library that does not fit is
 * refused. See solvers/plugin/README.md; solvers/plugin/example is a complete solver. */
#ifndef CLOTHBENCH_PLUGIN_H
#define CLOTHBENCH_PLUGIN_H
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CLOTHBENCH_PLUGIN_VERSION 1u

#if defined(__GNUC__)
#define CLOTHBENCH_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define CLOTHBENCH_PLUGIN_EXPORT
#endif

/* Features: what a scene needs, a solver supports, a stage serves. */
enum {
  CLOTHBENCH_STRETCH = 1 << 0,
  CLOTHBENCH_SHEAR = 1 << 1,
  CLOTHBENCH_BEND = 1 << 2,
  CLOTHBENCH_DAMPING = 1 << 3,
  CLOTHBENCH_PINS = 1 << 4,
  CLOTHBENCH_MOVING_PINS = 1 << 5,
  CLOTHBENCH_SPHERE = 1 << 6,
  CLOTHBENCH_BOX = 1 << 7,
  CLOTHBENCH_PLANE = 1 << 8,
  CLOTHBENCH_CAPSULES = 1 << 9,
  CLOTHBENCH_STATIC_MESH = 1 << 10,
  CLOTHBENCH_MOVING_MESH = 1 << 11,
  CLOTHBENCH_FRICTION = 1 << 12,
  CLOTHBENCH_DOUBLE_SIDED = 1 << 13,     /* contact from both sides without a second layer */
  CLOTHBENCH_DUPLICATED_LAYER = 1 << 14, /* a second, oppositely wound layer tied to the first */
  CLOTHBENCH_SELF_COLLISION = 1 << 15,
  CLOTHBENCH_RENDER = 1 << 16,
  CLOTHBENCH_UNEVEN_GRID = 1 << 17, /* cells of different widths */
  CLOTHBENCH_REGIONS = 1 << 18,     /* a membrane stiffness that varies between columns */
  CLOTHBENCH_SPIN = 1 << 19,        /* an initial spin: the velocity differs between vertices */
  CLOTHBENCH_CLOTH_MESH = 1 << 20 /* a triangle mesh instead of a grid: columns is the number of vertices, rows is 1 */
};

/* How a step ended. Any other than OK ends the run and becomes its status in the results. */
enum {
  CLOTHBENCH_OK = 0,
  CLOTHBENCH_NOT_FINITE = 1,
  CLOTHBENCH_DIVERGED = 2,
  CLOTHBENCH_DEVICE_LOST = 3,
  CLOTHBENCH_TIMED_OUT = 4
};

/* An edge of the grid. `membrane_stiffness_N_per_m` is the sheet's Y = E h at the edge, infinity if it is inextensible.
 * The solver chooses how to model it, as a spring or a constraint. The edge stands for a piece of cloth `along_m` x
 * `across_m`; on the border `across_m` is half a cell. A skip edge joins two vertices with one between them, number
 * (a + b) / 2. Its `along_m` is the distance to that vertex, and its stiffness is 0. */
typedef struct ClothbenchEdge {
  uint32_t a, b;
  double rest_m, membrane_stiffness_N_per_m, along_m, across_m;
} ClothbenchEdge;

enum {
  CLOTHBENCH_SHAPE_PLANE = 0,
  CLOTHBENCH_SHAPE_SPHERE = 1,
  CLOTHBENCH_SHAPE_BOX = 2,
  CLOTHBENCH_SHAPE_CAPSULES = 3,
  CLOTHBENCH_SHAPE_MESH = 4
};

/* An obstacle that the cloth must not penetrate. ClothbenchPose has its capsules or vertices; their numbers and the
 * triangles never change. */
typedef struct ClothbenchCollider {
  int32_t shape;
  int32_t moves;                    /* 1: its pose changes from frame to frame */
  double margin_m;                  /* distance from the surface at which contact stops the cloth */
  double friction;                  /* Coulomb coefficient between cloth and collider */
  double center_m[3];               /* plane: a point on it; sphere, box: centre */
  double normal[3];                 /* plane: unit vector into free space */
  double radius_m;                  /* sphere */
  double half_extent_m[3], axes[9]; /* box: half extents along its axes; three orthonormal axes */
  uint32_t capsule_count, vertex_count, triangle_count;
  int32_t closed;            /* mesh: closed surface of a solid, with outward normals */
  const uint32_t* triangles; /* 3 each, counter-clockwise seen from free space */
} ClothbenchCollider;

typedef struct ClothbenchPose {
  const double* capsules; /* 7 each: ends a and b [m], radius [m] */
  const double* vertices_m;
} ClothbenchPose;

typedef struct ClothbenchScene {
  uint32_t struct_size;
  uint32_t needs; /* features; `create` is called only for scenes whose needs the solver supports or ignores */
  uint32_t columns, rows, vertex_count;
  double width_m, height_m, areal_density_kg_per_m2;
  double bending_rigidity_N_m, damping_per_s; /* damping: dv/dt = -c v */
  double gravity_m_per_s2[3];
  double frame_rate_hz;
  uint32_t frames;
  const double *position_m, *velocity_m_per_s, *mass_kg; /* at the start; one mass per vertex */
  uint32_t triangle_count;
  const uint32_t* triangles;
  uint32_t structural_count, shear_count, skip_count;
  const ClothbenchEdge *structural_edges, *shear_edges, *skip_edges;
  uint32_t pin_count;
  const uint32_t* pins; /* vertices fixed at their initial positions */
  uint32_t grip_count;
  const uint32_t* grips; /* vertices with prescribed motion, held by hands or bars: see ClothbenchFrame */
  uint32_t collider_count;
  const ClothbenchCollider* colliders;
  const ClothbenchPose* poses;            /* one per collider, at the start */
  double self_thickness_m, self_friction; /* distance between two layers of the cloth in contact, 0: no
                                             self-collision; Coulomb coefficient of cloth on cloth */
} ClothbenchScene;

/* One displayed frame. Its data hold at the frame's end; between frames positions change linearly. */
typedef struct ClothbenchFrame {
  uint32_t struct_size;
  int32_t index;
  double time_s, dt_s;
  const ClothbenchPose* poses;   /* one per collider */
  const double* grip_position_m; /* one per grip */
  const uint8_t* grip_held;      /* one per grip: 0 from its release on */
} ClothbenchFrame;

/* A setting of the solver: `--set solver.<name>=VALUE`. */
typedef struct ClothbenchSetting {
  const char *name, *doc;
  double default_value;
  int32_t integer; /* 1: only whole numbers */
} ClothbenchSetting;

/* A stage of a frame. All stages together must serve exactly the features that the scene needs, without those that the
 * solver ignores: a solver must not do work that the scene does not need. */
typedef struct ClothbenchStage {
  const char* name;
  uint32_t serves; /* features; 0: work that every frame needs */
  int32_t dispatches;
  double read_B, write_B; /* bytes per frame that its shaders load and store, NAN if not known */
} ClothbenchStage;

typedef struct ClothbenchPlugin {
  /* CLOTHBENCH_PLUGIN_HEADER fills these. */
  uint32_t version, plugin_size, scene_size, frame_size, edge_size, collider_size, pose_size, setting_size, stage_size;
  const char* name;    /* letters, digits, . _ -; for tables and file names; no solver of clothbench may have it */
  const char* summary; /* one line */
  const char* solver_version; /* raise it when results change */
  const char* precision;      /* "float32" or "float64" */
  uint32_t supports, ignores; /* features; a scene that needs any other gives a row `unsupported` */
  int32_t time_order;         /* order of accuracy in the time step */
  uint32_t setting_count;
  const ClothbenchSetting* settings;

  /* Creates a solver in the initial state of the scene. The values are in the order of `settings`. Timed as set-up.
   * Returns NULL on failure, with the reason in `why`. */
  void* (*create)(const double* settings, const ClothbenchScene*, const char** why);
  void (*destroy)(void*);
  /* Continues from these positions and velocities: the scene's initial ones or those that `read_state` gave. Returns 0
   * and changes nothing if they are not the whole state of the solver. May be NULL if there is a `reset`. */
  int32_t (*restart)(void*, const double* position_m, const double* velocity_m_per_s);
  /* Computes one frame, complete on return. This call is timed. */
  int32_t (*step)(void*, const ClothbenchFrame*);
  void (*read_state)(void*, double* position_m, double* velocity_m_per_s);
  const ClothbenchStage* (*stages)(void*, uint32_t* count);

  /* The rest may be NULL. */
  void (*reset)(void*); /* restores the initial state, bit for bit; NULL: `restart` is called instead */
  /* Vertical displacement [m], downwards negative, of a body in free fall with the solver's integrator; NULL: the exact
   * solution. */
  double (*free_fall_m)(const double* settings, double dt_s, double gravity_m_per_s2, double velocity_m_per_s,
                        double damping_per_s, int32_t frames);
  const char* (*device)(void*); /* NULL: the CPU */
  double (*device_s)(void*);    /* device time of the last frame; not NULL: the solver runs on a GPU */

  /* Older libraries end above this line. `plugin_size` shows that, and they keep working. */
  /* Distance [m] at which the solver keeps the cloth from the scene's collider of this index, for metrics of contact.
   * NAN, or a NULL function: the collider's margin_m. */
  double (*contact_margin_m)(void*, uint32_t collider);
} ClothbenchPlugin;

#define CLOTHBENCH_PLUGIN_HEADER                                                                                 \
  CLOTHBENCH_PLUGIN_VERSION, (uint32_t)sizeof(ClothbenchPlugin), (uint32_t)sizeof(ClothbenchScene),              \
      (uint32_t)sizeof(ClothbenchFrame), (uint32_t)sizeof(ClothbenchEdge), (uint32_t)sizeof(ClothbenchCollider), \
      (uint32_t)sizeof(ClothbenchPose), (uint32_t)sizeof(ClothbenchSetting), (uint32_t)sizeof(ClothbenchStage)

CLOTHBENCH_PLUGIN_EXPORT const ClothbenchPlugin* clothbench_plugin(void);

#ifdef __cplusplus
}
#endif
#endif
