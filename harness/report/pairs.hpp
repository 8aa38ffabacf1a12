#pragma once
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// Distance between each vertex's positions in two runs, in the unit of the relation's map. NaN and empty if the two
/// have no trajectories of the same length.
struct Apart {
  double end = kMissing, most = kMissing;  ///< greatest over the vertices: at the end, and over all frames
  double coordinate = kMissing;            ///< greatest difference of one coordinate over all frames
  std::vector<double> rms = {};            ///< over the vertices, by frame
};

struct PairRelation;

/// Two runs of a study that a relation compares: `run` as it is (with its kind, scene and series), and `other`, which
/// names it in the study file ("pair").
struct RunPair : ContactRow {
  const RunRecord* other = nullptr;
  const PairRelation* relation = nullptr;
  Apart apart = {};
  double value = kMissing;  ///< what the relation bounds

  bool both_ok() const { return run->outcome.status == "ok" && other->outcome.status == "ok"; }
  bool within() const;  ///< value is at most the bound; false if either is unknown
};

/// A relation of two runs, one row of the table in pairs.cpp:
///   turned-over  square cloth with axis_u and axis_v exchanged: RMS distance up to 0.1 s after the first contact over
///                the longer side, at most 0.05. Later differences are not judged: rounding decides how a cloth folds
///   whole-room   a room against the part cut out of it: greatest distance [m]
///   irrelevant   features without effect are switched on: greatest distance over the longer side, at most 1e-6
///   finer        more substeps: popping of `run` minus that of `other` [m], at most 0.01
///   even-frames  a hitch or jitter: error, `other` over `run`, at most 3
///   scale        lengths and accelerations by a power of two: greatest difference over the width, 0
///   resolution   finer cells: greatest strain of the last second, `other` over `run`
///   repeat       the same run in another process: greatest difference over the width, 0
///   seed         another seed: greatest difference over the width
///   grid         a triangle mesh against a grid of about as many vertices: GPU time, `other` over `run`
///   before       the same run in another result (`clothbench compare`): greatest distance over the longer side, 0
struct PairRelation {
  enum class Map { None, Same, Transposed, Shape };  ///< Shape: relative to the cloth's centre, in widths

  const char* name;  ///< in study files
  Map map;
  double (*value)(const RunPair&);
  double bound;  ///< NaN: reported, not judged
  /// For a study stored before its file named pairs: finite if the first run is compared with the second, which is the
  /// one with the least value.
  double (*formerly)(const ContactRow& other, const nlohmann::json& its, const ContactRow& run,
                     const nlohmann::json& scenario);
};

/// Of the run's cloth [m]; NaN if it has none.
double longer_side(const RunRecord&);

/// All pairs of the relation, in the order of `run`: as the study file names them (Study::definition, "pairs"), and by
/// `formerly` for runs that it compares with none. Leaves out runs without a file. Throws Error for an unknown
/// relation. Reads trajectories from the runs' files if the records do not hold them.
std::vector<RunPair> run_pairs(const std::vector<ContactRow>&, const std::string& relation);
std::vector<RunPair> run_pairs(const std::vector<RunRecord>&, const std::string& relation);

/// These two runs by the relation, whatever their study compares them with.
RunPair pair_of(const RunRecord& run, const RunRecord& other, const std::string& relation);

}  // namespace clothbench
