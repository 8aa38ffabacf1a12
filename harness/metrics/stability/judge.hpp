#pragma once
#include <optional>
#include <string>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"
#include "metrics/stability/envelope.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

struct TruthErrors;

/// Thresholds of the outcome classes, all chosen for this project; published work rarely states its own.
namespace stability {
inline constexpr double kSpeed = 10;        ///< F0: times v_char
inline constexpr double kGain = 0.1;        ///< F1: energy gained over M g L
inline constexpr double kStrain = 0.10;     ///< F2: maximum strain beyond the truth, for more than ...
inline constexpr int kStrainFrames = 3;     ///< ... so many frames in a row
inline constexpr double kStrainP99 = 0.05;  ///< F2: 99th percentile, in any frame
inline constexpr double kTorn = 1;          ///< F2: strain beyond the truth in any frame
inline constexpr double kRelaxed = 0.01;    ///< mean |strain| below which F1 and F2 start to count, where delayed
inline constexpr double kQuantity = 0.02, kQuantityLength = 1e-3;  ///< F2 at the end: error of the quantity at rest
}  // namespace stability

/// One frame rated by the outcome classes F0 not finite or unbounded, F1 energy gained, F2 strain beyond the load (F3,
/// budget and device, is the runner's). The numbers are compared with the thresholds above. NaN: not defined for the
/// scene, or not yet counted.
struct StabilityFrame {
  unsigned classes = 0;             ///< bit k: Fk, only classes that the scene judges
  double speed = kMissing;          ///< maximum vertex speed over v_char
  double energy_gain = kMissing;    ///< over M g L (M v_char^2 without gravity)
  double strain_excess = kMissing;  ///< maximum
  /// Whether the run cannot recover.
  bool lost() const { return (classes & 3u) != 0; }
};

/// Judges the frames of one run, in order, by its scene's rules: a pure function of frames, scene and truth.
///
/// The energy gain compares visible energy (kinetic and gravitational) with the available energy: the energy at the
/// start, including elastic energy (from the strain, E = Y A e^2/2), and the maximum work of hands and colliders. So
/// the elastic energy of a model, which solvers without a modulus do not have, is never counted twice.
class StabilityJudge {
 public:
  explicit StabilityJudge(const Scene&);
  StabilityFrame judge(int frame, const ClothState&, const TruthErrors*);

 private:
  struct Strain {
    double mean, rms, greatest, p99;  ///< mean of |e|; the others signed
  };
  Strain strain_of(const std::vector<double>& x) const;
  void judge_motion(int frame, const ClothState&, const Strain&, StabilityFrame&);
  void judge_strain(int frame, const Strain&, const TruthErrors*, StabilityFrame&);
  double visible_energy(const ClothState&) const;
  bool settled(int frame) const;

  const Scene& scene_;
  const std::vector<stability::Bounds> bounds_;
  const std::vector<double> mass_, start_;
  const std::vector<Edge> edges_;
  std::optional<truth::ReferenceCase> at_rest_;  ///< the scene's reference case if it describes a shape at rest
  double total_mass_ = 0, longer_m_ = 0, g_ = 0, stiffness_ = 0;
  bool relaxed_ = false, ever_relaxed_ = false;
  int stretched_frames_ = 0;
  double energy_base_J_ = 0, work_base_J_ = 0;
};

/// The rating of a whole pass.
struct StabilityVerdict {
  enum class Grade { Stable, Degraded, Failed };
  Grade grade = Grade::Stable;
  std::string klass = "ok";  ///< class of the first frame with the worst grade
  int frame = -1;            ///< that frame
};

/// From a pass's series `stability_classes`: failed by F0 or F1, degraded by F2.
StabilityVerdict stability_verdict(const AccuracyPass&);

const char* name_of(StabilityVerdict::Grade);

/// Label of a class: "F1 energy gained".
std::string class_name(int k);

}  // namespace clothbench
