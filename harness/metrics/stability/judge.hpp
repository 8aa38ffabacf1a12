#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"
#include "metrics/stability/crossing.hpp"
#include "metrics/stability/envelope.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

struct TruthErrors;

/// Thresholds of the outcome classes, all chosen for this project; published work rarely states its own.
namespace stability {
inline constexpr double kSpeed = 10;        ///< F1: times v_char
inline constexpr double kGain = 0.1;        ///< F2: energy gained over M g L
inline constexpr double kStrain = 0.10;     ///< F3: greatest strain beyond the truth, for more than ...
inline constexpr int kStrainFrames = 3;     ///< ... so many frames in a row
inline constexpr double kStrainP99 = 0.05;  ///< F3: 99th percentile, in any frame
inline constexpr double kTorn = 1;          ///< F3: strain beyond the truth in any frame
inline constexpr double kAreaLow = 0.05, kAreaHigh = 4, kFoldDegrees = 170, kBadShare = 0.01;  // F4
inline constexpr double kDepthMargins = 2, kDepthCells = 0.25, kContactGrace_s = 0.25;         // F5
inline constexpr double kUnrest = 1e-3, kDriftPerMinute = 1e-3, kDriftFrom_s = 10;             // F6
inline constexpr double kFall = 0.01, kFallFrom_s = 0.1;                                       // F7
inline constexpr double kRelaxed = 0.01;  ///< mean |strain| below which F1 to F3 start to count, where delayed
inline constexpr double kQuantity = 0.02, kQuantityLength = 1e-3;  ///< F3 at the end: error of the quantity at rest
}  // namespace stability

/// One frame rated by the outcome classes
///   F0 not finite   F1 speed      F2 energy gain   F3 strain     F4 geometry
///   F5 contact      F6 unrest     F7 stagnation    (F8, budget and device, is the runner's)
/// The numbers are compared with the thresholds above. NaN: not defined for the scene, or not yet counted.
struct StabilityFrame {
  unsigned classes = 0;           ///< bit k: Fk, only classes that the scene judges
  double speed = kMissing;        ///< greatest vertex speed over v_char
  double energy_gain = kMissing;  ///< over M g L (M v_char^2 without gravity)
  double strain_excess = kMissing, strain_p99 = kMissing;
  double bad_geometry = kMissing;  ///< share of bad triangles or of bad folds, whichever is greater
  double depth = kMissing;         ///< over its limit; infinite: tunnelled
  double unrest = kMissing;        ///< RMS speed over sqrt(g L)
  double fall_error = kMissing;    ///< of the centre of mass, over g T^2/2
};

/// Judges the frames of one run, in order, by its scene's rules: a pure function of frames, scene and truth.
///
/// The energy gain compares visible energy (kinetic and gravitational) with all energy available: that at the start,
/// including elastic energy (from the strain, E = Y A e^2/2), and the most work that hands and colliders can have done.
/// So the elastic energy of a model, which solvers without a modulus do not have, is never counted twice.
class StabilityJudge {
 public:
  explicit StabilityJudge(const MetricContext&);
  StabilityFrame judge(int frame, const ClothState&, const SceneContact*, const TruthErrors*);

 private:
  struct Strain {
    double mean, rms, greatest, p99;  ///< mean of |e|; the others signed
  };
  Strain strain_of(const std::vector<double>& x) const;
  void judge_motion(int frame, const ClothState&, const Strain&, StabilityFrame&);
  void judge_strain(int frame, const Strain&, const TruthErrors*, StabilityFrame&);
  void judge_geometry(const ClothState&, StabilityFrame&) const;
  void judge_contact(int frame, const ClothState&, const SceneContact*, StabilityFrame&);
  void judge_rest(int frame, const ClothState&, StabilityFrame&);
  void judge_fall(int frame, const ClothState&, StabilityFrame&) const;
  double visible_energy(const ClothState&) const;
  bool settled(int frame) const;

  const MetricContext context_;
  const Scene& scene_;
  const std::vector<stability::Bounds> bounds_;
  const std::vector<double> mass_, start_;
  const std::vector<Edge> edges_;
  const std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::array<std::uint32_t, 4>> folds_;  ///< two triangles' corners: shared edge, then the two others
  std::optional<truth::ReferenceCase> at_rest_;      ///< the scene's reference case if it describes a shape at rest
  std::unique_ptr<stability::CapsuleCrossing> crossing_;
  double total_mass_ = 0, longer_m_ = 0, g_ = 0, stiffness_ = 0;
  bool relaxed_ = false, ever_relaxed_ = false;
  int stretched_frames_ = 0;
  double energy_base_J_ = 0, work_base_J_ = 0;
  std::vector<double> settled_at_;
  double settled_s_ = 0;
};

/// The rating of a whole pass.
struct StabilityVerdict {
  enum class Grade { Stable, Degraded, Failed };
  Grade grade = Grade::Stable;
  std::string klass = "ok";  ///< class of the first frame with the worst grade
  int frame = -1;            ///< that frame
};

/// From a pass's series `stability_classes`: failed by any of F0, F1, F2, F4, F5, F7, degraded by F3 or F6.
StabilityVerdict stability_verdict(const AccuracyPass&);

const char* name_of(StabilityVerdict::Grade);

/// Label of a class: "F2 energy gain".
std::string class_name(int k);

}  // namespace clothbench
