// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "operator_console/export/geo_frame.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// The map from above, a pixel a column of cells, its highest cell; north (+Y) up; deflated TIFF with GeoTIFF
/// keys and GDAL's tags. Without an origin in metres of the mission frame; with one in metres of GeoFrame's
/// projection (a matrix where the heading turns the picture).
///
/// Labels: band of 8 bits (16 for more than 255 labels) with the legend's colours; the value is the label's
/// place in the legend, counted from 1 by ascending label, 0 = nobody was there. Which value is which label
/// stands in geotiffLegend().
/// @throws std::runtime_error when the map spans more than 2^28 columns, or has more than 65535 labels.
std::string labelsGeoTiff(const mapping::MissionView& view, const GeoFrame* frame);

/// Certainty in [0, 1] as a band of floats, NaN = nobody was there. @throws as labelsGeoTiff().
std::string certaintyGeoTiff(const mapping::MissionView& view, const GeoFrame* frame);

/// What lies beside labelsGeoTiff() as FILE.aux.xml: the names of its values for GDAL and QGIS.
std::string geotiffLegend(const mapping::MissionView& view);

}  // namespace shoal::console
