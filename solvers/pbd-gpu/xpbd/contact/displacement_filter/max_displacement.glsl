/// Adds vertex i's displacement in the frame to the maximum. Called in the last substep.
void record_displacement(uint i, vec3 at) {
  uint displacement = floatBitsToUint(distance(at, motion_bounds[i].xyz));
  atomicMax(frame_state.max_displacement, displacement);
#ifndef FUSED_FRAME
  atomicMax(diagnostics.max_displacement, displacement);
#endif
}
