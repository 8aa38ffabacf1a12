/// At the frame's end.
void note_way(uint i, vec3 at) {
  uint way = floatBitsToUint(distance(at, LOAD16(reaches, i).xyz));
  atomicMax(ledger.farthest, way);
#ifndef PLANE_FRAME
  atomicMax(faults.farthest, way);
#endif
}
