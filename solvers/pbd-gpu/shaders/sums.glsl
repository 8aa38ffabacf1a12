/// a + b = sum + rest exactly (Knuth's two-sum).
void two_sum(vec3 a, vec3 b, out vec3 sum, out vec3 rest) {
  precise vec3 s = a + b;
  precise vec3 part = s - a;
  precise vec3 left = (a - (s - part)) + (b - part);
  sum = s;
  rest = left;
}
