// What host and shaders share: vec4 and 4-byte scalars only, so that std430 and C++ agree.
#ifdef __cplusplus
#pragma once
#include <array>
namespace clothbench::render {
using vec4 = std::array<float, 4>;
#endif

// Push constants of every draw; 128 B is what every device has.
struct Drawn {
  vec4 to_clip[4];  // columns of projection * view, in metres from the picture's origin
  vec4 eye;         // xyz: of the viewer, from the same origin [m]
  vec4 sheet;       // of a grid: columns and rows of vertices, squares of the checker along u and v; of a mesh: its
                    // triangles, 0, its vertices, 0
  vec4 origin;      // xyz: added to the cloth's positions [m]
  vec4
      follow;  // xyz: where vertex w of the cloth began [m]; the picture goes with it. w < 0: the picture does not move
};

// Look of a collider's vertex.
#define LOOK_SMOOTH 0
#define LOOK_FLAT 1  // lit by its triangles' own normals
#define LOOK_MARK 2  // a small dark sphere: an attached vertex

#ifdef __cplusplus
static_assert(sizeof(Drawn) == 128);
}  // namespace clothbench::render
#endif
