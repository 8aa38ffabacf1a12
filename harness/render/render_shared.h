// Types that host and shaders share: vec4 and 4-byte scalars only, so that std430 and C++ agree.
#ifdef __cplusplus
#pragma once
#include <array>
namespace clothbench::render {
using vec4 = std::array<float, 4>;
#endif

// Push constants of every draw; every device supports at least 128 B.
struct Drawn {
  vec4 to_clip[4];  // columns of projection * view, in metres from the picture's origin
  vec4 eye;         // xyz: of the viewer, from the same origin [m]
  vec4 sheet;       // xy: triangles and vertices of the cloth
  vec4 origin;      // xyz: added to the cloth's positions [m]
};

// Look of a collider's vertex.
#define LOOK_SMOOTH 0
#define LOOK_FLAT 1  // lit by its triangles' own normals
#define LOOK_MARK 2  // a small dark sphere: an attached vertex

#ifdef __cplusplus
static_assert(sizeof(Drawn) == 112);
}  // namespace clothbench::render
#endif
