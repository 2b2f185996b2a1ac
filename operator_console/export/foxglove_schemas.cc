// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/foxglove_schemas.h"

namespace shoal::console {

// As @foxglove/schemas 2.1.0 (MIT) has them, without their descriptions; tests/system/mcap_test.mjs compares.
// clang-format off
const std::string_view kPointCloudSchema = R"json({"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer",
"minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"frame_id":{"type":"string"},
"pose":{"type":"object","properties":{"position":{"type":"object","properties":{"x":{"type":"number"},
"y":{"type":"number"},"z":{"type":"number"}},"required":["x","y","z"]},"orientation":{"type":"object",
"properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}},
"required":["x","y","z","w"]}},"required":["position","orientation"]},"point_stride":{"type":"integer",
"minimum":0},"fields":{"type":"array","items":{"type":"object","properties":{"name":{"type":"string"},
"offset":{"type":"integer","minimum":0},"type":{"oneOf":[{"const":0},{"const":1},{"const":2},
{"const":3},{"const":4},{"const":5},{"const":6},{"const":7},{"const":8}]}},"required":["name","offset",
"type"]}},"data":{"type":"string","contentEncoding":"base64"}},"required":["timestamp","frame_id",
"pose","point_stride","fields","data"]})json";
const std::string_view kFrameTransformSchema = R"json({"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer",
"minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},
"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":{"type":"object",
"properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}},"required":["x","y",
"z"]},"rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},
"z":{"type":"number"},"w":{"type":"number"}},"required":["x","y","z","w"]}},"required":["timestamp",
"parent_frame_id","child_frame_id","translation","rotation"]})json";
const std::string_view kCompressedImageSchema = R"json({"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer",
"minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"frame_id":{"type":"string"},
"data":{"type":"string","contentEncoding":"base64"},"format":{"type":"string"}},"required":["timestamp",
"frame_id","data","format"]})json";
const std::string_view kLocationFixSchema = R"json({"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer",
"minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"frame_id":{"type":"string"},
"latitude":{"type":"number"},"longitude":{"type":"number"},"altitude":{"type":"number"},
"position_covariance":{"type":"array","items":{"type":"number"},"minItems":9,"maxItems":9},
"position_covariance_type":{"oneOf":[{"const":0},{"const":1},{"const":2},{"const":3}]},
"heading":{"type":"number"},"velocity":{"type":"object","properties":{"x":{"type":"number"},
"y":{"type":"number"},"z":{"type":"number"}},"required":["x","y","z"]},"color":{"type":"object",
"properties":{"r":{"type":"number"},"g":{"type":"number"},"b":{"type":"number"},"a":{"type":"number"}},
"required":["r","g","b","a"]},"metadata":{"type":"array","items":{"type":"object",
"properties":{"key":{"type":"string"},"value":{"type":"string"}},"required":["key","value"]}}},
"required":["timestamp","frame_id","latitude","longitude","altitude","position_covariance",
"position_covariance_type"]})json";
const std::string_view kLogSchema = R"json({"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer",
"minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"level":{"oneOf":[{"const":0},
{"const":1},{"const":2},{"const":3},{"const":4},{"const":5}]},"message":{"type":"string"},
"name":{"type":"string"},"file":{"type":"string"},"line":{"type":"integer","minimum":0}},
"required":["timestamp","level","message","name","file","line"]})json";
// clang-format on

}  // namespace shoal::console
