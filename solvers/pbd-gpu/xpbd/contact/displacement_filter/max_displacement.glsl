/// Adds vertex i's displacement in the frame to the maximum. Called in the last substep.
void record_displacement(uint i, vec3 at) {
  atomicMax(frame_state.max_displacement, floatBitsToUint(distance(at, motion_bounds[i].xyz)));
}
