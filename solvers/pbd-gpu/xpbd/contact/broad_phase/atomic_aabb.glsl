// Boxes in shared memory that many threads grow at once by integer atomics. ordered() maps floats to integers of the
// same order, so the result does not depend on the order of threads. NaN lies beyond all numbers.
uint ordered(float f) {
  uint bits = floatBitsToUint(f);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float of_ordered(uint u) { return uintBitsToFloat((u & 0x80000000u) != 0u ? u & 0x7fffffffu : ~u); }
const uint kLowNone = 0xffffffffu, kHighNone = 0u;
