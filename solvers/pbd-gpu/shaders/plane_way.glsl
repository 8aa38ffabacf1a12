#ifdef PLANE_FRAME
#define FARTHEST ledger.farthest
#else
#define FARTHEST faults.farthest
#endif
/// At the frame's end.
void note_way(uint i, vec3 at) {
  atomicMax(FARTHEST, floatBitsToUint(distance(at, LOAD16(reaches, i).xyz)));
}
