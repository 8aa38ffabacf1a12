// usage: make_sample FOLDER: one finished cell for the readers' tests.
#include <cstdio>
#include <filesystem>

#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "sample_cell.hpp"

int main(int argc, char** argv) {
  using namespace clothbench;
  if (argc != 2) return 2;
  std::filesystem::remove_all(argv[1]);
  std::filesystem::create_directories(argv[1]);
  const CellRecord r = sample_cell();
  CellWriter writer(argv[1], r.header);
  for (const TimedTrial& t : r.trials) writer.write_trial(t);
  writer.write_accuracy(r.accuracy);
  writer.write_replay(r.replay);
  std::puts(writer.finish(r.outcome, r.summary).c_str());
}
