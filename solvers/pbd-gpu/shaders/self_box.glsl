// A box at a share of the reaches, a power of two: with and without fused multiplication the same bits.
vec3 low_at(SelfBox b, float share) { return b.low_0.xyz + share * (b.low_1.xyz - b.low_0.xyz); }
vec3 high_at(SelfBox b, float share) { return b.high_0.xyz + share * (b.high_1.xyz - b.high_0.xyz); }
