#include "base/words.hpp"

#include <gtest/gtest.h>

#include "base/files.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

using Words = std::vector<std::string>;

TEST(Words, JoinsItemsByTheirText) {
  EXPECT_EQ(joined(Words{}), "");
  EXPECT_EQ(joined(Words{"a"}), "a");
  EXPECT_EQ(joined(Words{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(joined(Words{"", "b"}), "b");
  const std::vector<std::pair<std::string, int>> pairs = {{"a", 1}, {"b", 2}};
  EXPECT_EQ(joined(pairs, "; ", &std::pair<std::string, int>::first), "a; b");
}

TEST(Words, FindsOneAmongOthers) {
  EXPECT_TRUE(contains(Words{"a", "b"}, "b"));
  EXPECT_FALSE(contains(Words{"a", "b"}, "c"));
  EXPECT_FALSE(contains(Words{}, "a"));
}

TEST(Words, EndsASentenceOnAnUnknownOne) {
  EXPECT_EQ(nearest_known("substep", {"iterations", "substeps"}), "; nearest known: substeps");
  EXPECT_EQ(nearest_known("xyz", {"iterations", "substeps"}), "");
  EXPECT_EQ(nearest_known("x", {}), "");
}

TEST(Words, ContentOfAFileThatIsNotThereIsEmpty) { EXPECT_EQ(content_of("/no/such/file"), ""); }

}  // namespace
}  // namespace clothbench
