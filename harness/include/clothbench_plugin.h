/* Interface of a cloth solver in a shared library, for `clothbench … --solver plugin:path.so`. C99; needs no other
 * header of clothbench.
 *
 * The library exports one function, `clothbench_plugin`, which returns a description that stays valid. Units are SI.
 * Coordinates are right-handed. Vectors are x y z with +y up. Positions and velocities of vertices are interleaved and
 * ordered by rows of the grid: vertex i of row j has index j * columns + i. Pointers in a scene are valid until
 * `destroy`; pointers in a frame or a restart are valid until the call returns. Texts and arrays from the plugin must
 * stay valid until its next call. Calls come from one thread at a time. No exception or longjmp may cross them.
 *
 * CLOTHBENCH_PLUGIN_HEADER states the version of this interface, 1, and the sizes of its structs. A library whose
 * version or sizes differ was built with another header and is refused. See solvers/plugin/README.md;
 * solvers/plugin/example is a complete solver.
 *
 *   cc -std=c99 -O2 -shared -fPIC -I <folder of this file> mine.c -lm -o mine.so
 *   clothbench list solvers --solver plugin:mine.so      tests whether it loads
 *   clothbench conformance plugin:mine.so                tests what every solver must do */
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

/* Features. A scene needs features, a solver supports them, and a stage serves them. */
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
  CLOTHBENCH_DUPLICATED_LAYER = 1 << 14, /* a second, oppositely wound layer tied to the first; the solver makes it: the
                                            scene and `read_state` have the vertices of one layer */
  CLOTHBENCH_SELF_COLLISION = 1 << 15,
  CLOTHBENCH_UNEVEN_GRID = 1 << 16, /* cells of different widths */
  CLOTHBENCH_REGIONS = 1 << 17,     /* a membrane stiffness that varies between columns or groups */
  CLOTHBENCH_SPIN = 1 << 18,        /* an initial spin: the velocity differs between vertices */
  CLOTHBENCH_CLOTH_MESH = 1 << 19 /* a triangle mesh instead of a grid: columns is the number of vertices, rows is 1 */
};

/* How a step ended. A value other than OK ends the run and becomes the run's status in the results. */
enum {
  CLOTHBENCH_OK = 0,
  CLOTHBENCH_NOT_FINITE = 1,
  CLOTHBENCH_DIVERGED = 2,
  CLOTHBENCH_DEVICE_LOST = 3,
  CLOTHBENCH_TIMED_OUT = 4
};

/* An edge of the grid or mesh. `membrane_stiffness_N_per_m` is the sheet's Y = E h at the edge: the force per
 * width and strain of a strip that is pulled at one end. It is infinity if the sheet is inextensible. The solver
 * chooses how to model Y, as a spring or a constraint. The edge stands for a piece of cloth `along_m` x `across_m`:
 * - structural edge: its length, and the width of its cloth. In a grid this cloth is half a cell on each side, so on
 *   the border it is half a cell in all. In a mesh the width is the area of the edge's triangles divided by its length.
 * - shear edge, a diagonal of a cell: the cell's sides along the rows (`along_m`) and along the columns (`across_m`).
 *   Both diagonals of every cell are listed, and each stands for the whole cell.
 * - skip edge, from a to b with the vertex m = (a + b) / 2 between them: the length from a to m, and the width of a
 *   cell (on the border, half of it). Its stiffness is 0. It carries bending: a strip with bending rigidity B has the
 *   energy B across / (2 along^3) |a - 2 m + b|^2.
 *
 * `spring_N_per_m` makes a sheet with stiffness Y and Poisson's ratio 1/3, the only ratio that springs allow. In a
 * cell a x b, an edge of length a has Y (9/8 b/a - 3/8 a/b), but at least Y b / (10 a); on the border it has half of
 * that. Each diagonal has 3/16 Y (a^2 + b^2) / (a b). On square cells these are 3/4 Y, on the border 3/8 Y, diagonals
 * 3/8 Y. Without shear edges, and on a mesh, an edge has Y across / along (Van Gelder 1998, "Approximate Simulation of
 * Elastic Membranes by Triangulated Spring Meshes"). */
typedef struct ClothbenchEdge {
  uint32_t a, b;
  double rest_m, membrane_stiffness_N_per_m, along_m, across_m;
  double spring_N_per_m; /* see above; infinity if inextensible, 0 for skip edges */
} ClothbenchEdge;

enum {
  CLOTHBENCH_SHAPE_PLANE = 0,
  CLOTHBENCH_SHAPE_SPHERE = 1,
  CLOTHBENCH_SHAPE_BOX = 2,
  CLOTHBENCH_SHAPE_CAPSULES = 3,
  CLOTHBENCH_SHAPE_MESH = 4
};

/* An obstacle that the cloth must not penetrate. ClothbenchPose holds its capsules or vertices. The counts
 * and the triangles never change. */
typedef struct ClothbenchCollider {
  int32_t shape;
  int32_t moves;      /* 1: its pose changes from frame to frame */
  double margin_m;    /* distance from the surface at which contact stops the cloth */
  double friction;    /* Coulomb coefficient between cloth and collider */
  double center_m[3]; /* plane: a point on it; sphere, box: centre */
  double normal[3];   /* plane: unit vector into free space */
  double radius_m;    /* sphere */
  /* box: half extents along its three axes; then the axes, x y z each. They are unit vectors in world coordinates,
   * orthogonal and right-handed: the third is the cross product of the first two. */
  double half_extent_m[3], axes[9];
  uint32_t capsule_count, vertex_count, triangle_count;
  int32_t closed;            /* mesh: closed surface of a solid, with outward normals */
  const uint32_t* triangles; /* 3 each, counter-clockwise seen from free space */
} ClothbenchCollider;

typedef struct ClothbenchPose {
  const double* capsules; /* 7 each: ends a and b [m], radius [m] */
  const double* vertices_m;
} ClothbenchPose;

typedef struct ClothbenchScene {
  uint32_t needs; /* features; `create` is called only for scenes whose needs the solver supports or ignores */
  uint32_t columns, rows, vertex_count;
  double width_m, height_m, areal_density_kg_per_m2;
  double bending_rigidity_N_m, damping_per_s; /* damping: dv/dt = -c v */
  double gravity_m_per_s2[3];
  double frame_rate_hz;
  uint32_t frames;
  const double *position_m, *velocity_m_per_s, *mass_kg; /* at the start; one mass per vertex */
  /* 3 vertices each. In a grid, all triangles are counter-clockwise seen from the side to which u x v points; u and v
   * are the directions of growing i and j. Cell (i, j) has the triangles (i, j) (i+1, j) (i+1, j+1) and (i, j)
   * (i+1, j+1) (i, j+1). A mesh has the triangles of its file, with neighbours wound alike. */
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
  double self_thickness_m, self_friction; /* distance between two layers in contact (0: no self-
                                             collision); Coulomb coefficient of cloth on cloth */

  /* 3 per vertex: the cloth at rest, in world coordinates. A grid lies flat in its plane, even if it starts bent,
   * folded or scattered (position_m). This shape defines the rest lengths of edges. */
  const double* rest_position_m;
} ClothbenchScene;

/* One displayed frame. Its data describe the frame's end; between frames, positions change linearly. */
typedef struct ClothbenchFrame {
  int32_t index;
  double time_s, dt_s;
  const ClothbenchPose* poses;   /* one per collider */
  const double* grip_position_m; /* one per grip */
  const uint8_t* grip_held;      /* one per grip: 0 from its release on */

  const ClothbenchPose* poses_before; /* at the end of the frame before, or at the scene's start */
  /* One per collider, one per grip: 1 if it teleports in this frame, so that it has no velocity and may be put at its
   * new position at once. Both are NULL if the scene has no jump in this frame. If it has one, everything that moves
   * in this frame by more than half the distance of the jump is marked. */
  const uint8_t *collider_teleports, *grip_teleports;
} ClothbenchFrame;

/* A state of the cloth during a scene, and the colliders and grips at that time. */
typedef struct ClothbenchRestart {
  int32_t index; /* of the last finished frame; -1: the scene's start */
  double time_s; /* at the end of that frame */
  const double *position_m, *velocity_m_per_s;
  const ClothbenchPose* poses;   /* one per collider */
  const double* grip_position_m; /* one per grip; NULL if there are no grips or nothing moves */
  const uint8_t* grip_held;
} ClothbenchRestart;

/* The device of a solver. */
typedef struct ClothbenchDevice {
  const char *name, *driver, *api; /* "NVIDIA RTX 4090", "NVIDIA 570.86", "CUDA 12.8" */
  int32_t is_software;             /* 1: a CPU that emulates a GPU; its times are not a GPU's */
  const char* properties_json;     /* a JSON object of all that the API reports, or NULL */
} ClothbenchDevice;

/* A setting of the solver: `--set solver.<name>=VALUE`. */
typedef struct ClothbenchSetting {
  const char *name, *doc;
  double default_value;
  int32_t integer; /* 1: only whole numbers */
} ClothbenchSetting;

/* A stage of a frame. All stages together must serve exactly the features that the scene needs and the solver does not
 * ignore, because a solver must not do work that the scene does not need. */
typedef struct ClothbenchStage {
  const char* name;
  uint32_t serves; /* features; 0: work that every frame needs */
  int32_t dispatches;
  double read_B, write_B; /* bytes per frame that its shaders load and store, NAN if not known */
} ClothbenchStage;

/* A number that a solver counts in each frame, such as contacts, dropped contacts or iterations. */
typedef struct ClothbenchCount {
  const char *name, *doc; /* small letters, digits, _ ; one line */
  double value;           /* of the last frame; 0 before the first */
} ClothbenchCount;

typedef struct ClothbenchPlugin {
  /* CLOTHBENCH_PLUGIN_HEADER fills these. */
  uint32_t version, plugin_size, scene_size, frame_size, edge_size, collider_size, pose_size, setting_size, stage_size;
  const char* name;    /* letters, digits, . _ -; for tables and file names; not the name of a clothbench solver */
  const char* summary; /* one line */
  const char* solver_version; /* raise it when results change */
  const char* precision;      /* "float32" or "float64" */
  /* Features. A scene is run if the solver supports or ignores each feature that it needs; ignored features are not
   * simulated. A scene that needs any other feature gives a row `unsupported`. */
  uint32_t supports, ignores;
  int32_t time_order; /* order of accuracy in the time step */
  uint32_t setting_count;
  const ClothbenchSetting* settings;

  /* Creates a solver in the initial state of the scene. The values are in the order of `settings`. Timed as set-up.
   * Returns NULL on failure, with the reason in `why`. */
  void* (*create)(const double* settings, const ClothbenchScene*, const char** why);
  void (*destroy)(void*);
  /* Continues from the scene's start (index -1), which it restores bit for bit, or from a state that `read_state` gave.
   * Returns 0 and changes nothing if positions and velocities are not the solver's whole state at that time. */
  int32_t (*restart)(void*, const ClothbenchRestart*);
  /* Computes one frame, complete on return. This call is timed. */
  int32_t (*step)(void*, const ClothbenchFrame*);
  void (*read_state)(void*, double* position_m, double* velocity_m_per_s);
  const ClothbenchStage* (*stages)(void*, uint32_t* count);

  /* All members from here on may be NULL.
   *
   * Vertical displacement [m], downwards negative, of a body in free fall with the solver's integrator; NULL: the exact
   * solution. */
  double (*free_fall_m)(const double* settings, double dt_s, double gravity_m_per_s2, double velocity_m_per_s,
                        double damping_per_s, int32_t frames);
  /* Device time [s] of the last frame, from the start of its first work on the device to the end of its last; NAN if
   * not known. If this function is not NULL, the solver runs on a GPU. */
  double (*device_s)(void*);

  /* Distance [m] at which the solver keeps the cloth from the scene's collider of this index, for metrics of contact.
   * NAN, or a NULL function: the collider's margin_m. */
  double (*contact_margin_m)(void*, uint32_t collider);

  /* Why the solver cannot run this scene at these settings, beyond what `supports` says, as in "unsupported, because
   * …"; NULL if it can. Called before `create`; a reason gives a row `unsupported` and no error. */
  const char* (*unsupported)(const double* settings, const ClothbenchScene*);

  void (*device_info)(void*, ClothbenchDevice*); /* NULL: the CPU */

  /* Third-party engine that the solver wraps, in its authors' spelling: "NvCloth". A report compares the solver with
   * published results of the same engine. NULL: none. */
  const char* engine;

  /* Counts of the last frame: after every frame of a scene as many, in the same order. Each is stored as a series
   * `solver_<name>`. */
  const ClothbenchCount* (*counts)(void*, uint32_t* count);
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
