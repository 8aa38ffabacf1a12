// Included by every kernel. LOAD/STORE count bytes in the instrumented build, which the
// test of the byte table runs; in the normal build they are plain accesses.
#extension GL_EXT_control_flow_attributes : require
#ifdef SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
#include "common/gpu_types.h"

layout(local_size_x_id = 0) in;
#define SPECIALIZE(number, type, name, standard) layout(constant_id = number) const type name = standard;

/// Item of this invocation. Groups are one-dimensional; past 65535 of them they lie in rows (`groups_for`).
uint item() {
  return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}

#ifdef CLOTHBENCH_COUNT_BYTES
layout(std430, binding = BIND_COUNTER) buffer Counter { uint counted_read, counted_write; };
#define LOAD(bytes, array, i) (atomicAdd(counted_read, bytes), array[i])
#define LOAD16_OF(member) (atomicAdd(counted_read, 16u), member)
#define LOAD16(array, i) (atomicAdd(counted_read, 16u), array[i])
#define LOAD4(array, i) (atomicAdd(counted_read, 4u), array[i])
#define STORE16(array, i, value) { atomicAdd(counted_write, 16u); array[i] = (value); }
#define STORE4(array, i, value) { atomicAdd(counted_write, 4u); array[i] = (value); }
#define STORE32(array, i, value) { atomicAdd(counted_write, 32u); array[i] = (value); }
#define STORE64(array, i, value) { atomicAdd(counted_write, 64u); array[i] = (value); }
#define COUNT_ATOMIC { atomicAdd(counted_read, 4u); atomicAdd(counted_write, 4u); }
#define COUNT_READ(bytes) { atomicAdd(counted_read, bytes); }
#else
#define LOAD(bytes, array, i) (array[i])
#define LOAD16_OF(member) (member)
#define LOAD16(array, i) (array[i])
#define LOAD4(array, i) (array[i])
#define STORE16(array, i, value) { array[i] = (value); }
#define STORE4(array, i, value) { array[i] = (value); }
#define STORE32(array, i, value) { array[i] = (value); }
#define STORE64(array, i, value) { array[i] = (value); }
#define COUNT_ATOMIC
#define COUNT_READ(bytes) {}
#endif
