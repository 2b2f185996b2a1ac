// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/held_pictures.h"

namespace shoal::fusion_node {

/// What a picture shows as far as it is held: 32 x 32, BGR, CV_8UC3. Its layers are a peer's bytes: any of
/// them give some picture.
cv::Mat pixelsOf(const mapping::HeldPicture& picture);

/// The pictures of labels as FOLDER/10004.png, 10004_1.png, ..., the best first, and
/// FOLDER/pictures.json, which says of each label what they show. Nothing when there is no picture.
/// @returns the names of the files. @throws std::runtime_error naming a file that cannot be written.
std::vector<std::string> writeLabelPictures(const std::string& folder,
                                            const mapping::LabelPictures& pictures);

/// The pictures of one robot's topics as FOLDER/3.png, 3_1.png, ...
/// @returns the names of the files. @throws std::runtime_error naming a file that cannot be written.
std::vector<std::string> writeTopicPictures(const std::string& folder, const mapping::BeliefStore& beliefs,
                                            world::RobotId robot);

}  // namespace shoal::fusion_node
