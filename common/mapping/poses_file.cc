// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/poses_file.h"

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/csv.h"

namespace shoal::mapping {

std::string posesTxt(const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d t = pose.world_from_camera.translation();
    const Eigen::Quaterniond q(pose.world_from_camera.rotation());
    text += fixed(pose.time.seconds(), 6);
    for (const double metres : {t.x(), t.y(), t.z()}) text += ' ' + fixed(metres, 6);
    for (const double component : {q.x(), q.y(), q.z(), q.w()}) text += ' ' + fixed(component, 9);
    text += '\n';
  }
  return text;
}

std::vector<StampedPose> readPoses(const std::string& path) {
  std::vector<StampedPose> poses;
  std::istringstream file(readFile(path));
  int line_number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    std::array<double, 8> v{};
    for (double& x : v) fields >> x;
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (!fields || !(q.norm() > 0.5) || !std::isfinite(q.norm())) {
      throw std::runtime_error(path + " line " + std::to_string(line_number) +
                               ": should be \"timestamp tx ty tz qx qy qz qw\" with a unit quaternion");
    }
    StampedPose pose{{std::llround(v[0] * 1e6)}, world::Pose::Identity()};
    pose.world_from_camera.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    pose.world_from_camera.linear() = q.normalized().toRotationMatrix();
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace shoal::mapping
