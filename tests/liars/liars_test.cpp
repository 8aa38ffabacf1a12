// Wrong motions fail and correct motions pass by their positions only, without any bound of a scene.
#include <gtest/gtest.h>

#include "trial.hpp"

namespace clothbench::liars {
namespace {

/// A small matrix; matrix.py runs large ones.
TEST(Liars, AreToldFromRightMotions) {
  Matrix matrix;
  matrix.solver = "bullet-deformable";
  matrix.kinds = {"bar", "plate"};
  matrix.motions = 3;
  std::size_t told = 0, caught = 0;
  std::string missed;
  for (const Trial& t : tell_all(matrix)) {
    if (t.right) {
      EXPECT_FALSE(t.failed()) << as_json(t);
      continue;
    }
    if (!t.determined) continue;
    ++told, caught += t.failed();
    if (!t.failed()) missed += as_json(t).dump() + "\n";
  }
  EXPECT_GE(told, 60u);
  EXPECT_GE(static_cast<double>(caught), 0.97 * static_cast<double>(told)) << missed;
}

}  // namespace
}  // namespace clothbench::liars
