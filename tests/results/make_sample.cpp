// usage: make_sample FOLDER [START_UNIX_S]: writes one finished run for the readers' tests; with START_UNIX_S, the CBOR
// file that a device would leave. Its three trials of 0.4 s begin at START_UNIX_S + 0.2 s, half a second apart.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "results/store.hpp"
#include "sample_run.hpp"

int main(int argc, char** argv) {
  using namespace clothbench;
  if (argc != 2 && argc != 3) return 2;
  std::filesystem::remove_all(argv[1]);
  std::filesystem::create_directories(argv[1]);
  RunRecord r = sample_run();
  if (argc == 3)
    for (TimedTrial& t : r.trials) {
      t.start_unix_s = std::atof(argv[2]) + 0.2 + 0.5 * t.index;
      t.end_unix_s = t.start_unix_s + 0.4;
    }
  RunWriter writer(argv[1], r.header, argc == 3 ? Finish::Cbor : best_finish());
  for (const TimedTrial& t : r.trials) writer.write_trial(t);
  writer.write_accuracy(r.accuracy);
  writer.write_replay(r.replay);
  std::puts(writer.finish(r.outcome, r.summary).c_str());
}
