// Box of the positions for which a list is valid: _1, or for one substep (level 1) _0 grown by the vertices' limits.
vec3 low_at(SelfAabb b, uint level) { return level == 0u ? b.low_1.xyz : b.low_0.xyz - b.low_0.w; }
vec3 high_at(SelfAabb b, uint level) { return level == 0u ? b.high_1.xyz : b.high_0.xyz + b.low_0.w; }
