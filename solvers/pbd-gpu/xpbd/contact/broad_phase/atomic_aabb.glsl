// Boxes in shared memory that many threads widen at once: by whole numbers in the order of floats, so that the order of
// threads does not matter. A NaN is beyond all numbers.
uint ordered(float f) {
  uint bits = floatBitsToUint(f);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float of_ordered(uint u) { return uintBitsToFloat((u & 0x80000000u) != 0u ? u & 0x7fffffffu : ~u); }
const uint kLowNone = 0xffffffffu, kHighNone = 0u;
