// A box inflated by a fraction of the motion bounds. Fractions are powers of two, so fused multiply-adds round alike.
vec3 low_at(SelfAabb b, float fraction) { return b.low_0.xyz + fraction * (b.low_1.xyz - b.low_0.xyz); }
vec3 high_at(SelfAabb b, float fraction) { return b.high_0.xyz + fraction * (b.high_1.xyz - b.high_0.xyz); }
