#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "base/dice.hpp"
#include "motions.hpp"

namespace clothbench::liars {

using V3 = Eigen::Vector3d;

/// Properties of a scene and its correct motion, for the choice of lies. Frames count from 0, the start.
struct Facts {
  int equations = 6;       ///< number of the six momentum equations that attachments do not absorb
  bool falls = false;      ///< the scene has gravity
  bool attached = false;   ///< pins or grips
  bool collider = false;   ///< static or kinematic
  bool kinematic = false;  ///< a kinematic collider
  bool self = false;       ///< the cloth has self-contact
  bool slides = false;     ///< only planes; steep, or cloth too fast to stop in a tenth of a second
  std::size_t frames = 0;
  std::size_t first_touch = 0;    ///< first frame with a collider in reach; `frames` if there is none
  std::size_t at_rest = 0;        ///< first frame from which on the cloth stays within 0.2 % of its length
  std::size_t fastest = 0;        ///< frame of the highest RMS speed
  std::size_t deepest_touch = 0;  ///< if kinematic: the frame with most contacts; otherwise `frames`
  std::vector<std::size_t> air;   ///< frames without contact, also in both neighbouring frames
  double speed_m_per_s = 0;       ///< at `fastest`
  double frame_s = 0;             ///< duration of a frame
  double length_m = 1;
  double gravity = 0;      ///< [m/s2]
  double soft_strain = 0;  ///< compression that the scene's weight, speeds and recoil explain
  double offset_m = 0;     ///< the largest contact offset
  V3 up{};                 ///< unit vector against gravity
};

/// A correct motion, and other motions of its scene and solver that a lie may need.
struct Right {
  Motion motion;
  Facts facts;
  /// Motion of the scene with something changed; none if the solver fails.
  std::function<std::optional<Motion>(const std::function<void(Scene&)>&)> other;
  bool held(std::size_t frame, std::size_t vertex) const;
};

Facts facts_of(const Motion&);

/// Whether a lie changes, by more than the check's tolerance, a force or moment that attachments cannot exert; in one
/// interval, or on average over 3 or 12 intervals.
bool changes_force(const Right&, const Motion& told);

/// One way of falsifying a motion. Attached vertices stay at their prescribed positions unless the lie is about them.
struct Lie {
  const char* name;
  bool (*applies)(const Facts&);
  /// Whether positions determine that the motion is wrong; decided before the check runs.
  bool (*determined)(const Right&, const Motion& told);
  std::optional<Motion> (*tell)(const Right&, Dice&);
  bool right = false;  ///< a control: it must pass
};

/// All lies, after the controls. No lie is about velocities, because files do not store them.
const std::vector<Lie>& lies();

/// First frame that differs from the correct motion; the number of frames if none does.
std::size_t first_difference(const Right&, const Motion& told);
/// Largest second difference [m] of a vertex in the frames around `frame`.
double accelerated_m(const Motion&, std::size_t frame);

/// Largest distance [m] of a vertex from its position in the correct motion.
double difference_m(const Right&, const Motion&);

}  // namespace clothbench::liars
