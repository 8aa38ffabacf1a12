// Included by every kernel.
#extension GL_EXT_control_flow_attributes : require
#ifdef SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#include "common/gpu_types.h"

layout(local_size_x_id = 0) in;
#define SPECIALIZE(number, type, name, standard) layout(constant_id = number) const type name = standard;

/// Global index of this invocation. Workgroups are one-dimensional, in rows if there are more than 65535 (groups_for).
uint item() {
  return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}
