// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/geotiff.h"

#include <geotiff/geotiffio.h>
#include <geotiff/xtiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "operator_console/render.h"
#include "operator_console/xml_text.h"

namespace shoal::console {
namespace {

constexpr int64_t kMaxColumns = int64_t{1} << 28;

// ---------- a file in memory, as libtiff wants one

struct Memory {
  std::string bytes;
  size_t at = 0;
};

Memory& memory(thandle_t handle) { return *static_cast<Memory*>(handle); }

tmsize_t readSome(thandle_t handle, void* to, tmsize_t size) {
  Memory& m = memory(handle);
  const size_t n = std::min(static_cast<size_t>(size), m.bytes.size() - std::min(m.at, m.bytes.size()));
  if (n > 0) std::memcpy(to, m.bytes.data() + m.at, n);
  m.at += n;
  return static_cast<tmsize_t>(n);
}

tmsize_t writeSome(thandle_t handle, void* from, tmsize_t size) {
  Memory& m = memory(handle);
  const auto n = static_cast<size_t>(size);
  if (m.bytes.size() < m.at + n) m.bytes.resize(m.at + n);
  if (n > 0) std::memcpy(m.bytes.data() + m.at, from, n);
  m.at += n;
  return size;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  Memory& m = memory(handle);
  if (whence == SEEK_SET) m.at = offset;
  if (whence == SEEK_CUR) m.at += offset;
  if (whence == SEEK_END) m.at = m.bytes.size() + offset;
  return m.at;
}

int close(thandle_t) { return 0; }
toff_t sizeOf(thandle_t handle) { return memory(handle).bytes.size(); }

// ---------- tags of GDAL's own

constexpr uint32_t kGdalMetadata = 42112, kGdalNoData = 42113;
TIFFExtendProc parent_extender = nullptr;

void addGdalTags(TIFF* tiff) {
  static std::array<char, 14> metadata{"GDALMetadata"}, no_data{"GDALNoDataVal"};
  static const std::array<TIFFFieldInfo, 2> fields{
      TIFFFieldInfo{kGdalMetadata, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, metadata.data()},
      TIFFFieldInfo{kGdalNoData, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, no_data.data()}};
  TIFFMergeFieldInfo(tiff, fields.data(), fields.size());
  if (parent_extender != nullptr) parent_extender(tiff);
}

// ---------- the map as rows

struct Raster {
  int32_t min_x = 0, max_y = 0;
  uint32_t width = 1, height = 1;
  std::vector<const mapping::GlobalCell*> cells;  // row by row from the north, nullptr: nobody was there
};

Raster rasterOf(const mapping::GlobalMap& map) {
  Raster raster;
  if (!map.cells.empty()) {
    int32_t max_x = std::numeric_limits<int32_t>::min(), min_y = std::numeric_limits<int32_t>::max();
    raster.min_x = min_y, raster.max_y = max_x;
    for (const mapping::GlobalCell& c : map.cells) {
      raster.min_x = std::min(raster.min_x, c.cell.x);
      raster.max_y = std::max(raster.max_y, c.cell.y);
      max_x = std::max(max_x, c.cell.x);
      min_y = std::min(min_y, c.cell.y);
    }
    const int64_t width = int64_t{max_x} - raster.min_x + 1, height = int64_t{raster.max_y} - min_y + 1;
    if (width > kMaxColumns || height > kMaxColumns || width * height > kMaxColumns)
      throw std::runtime_error(
          fmt::format("the map spans {} x {} columns: too many for a picture", width, height));
    raster.width = static_cast<uint32_t>(width);
    raster.height = static_cast<uint32_t>(height);
  }
  raster.cells.resize(size_t{raster.width} * raster.height);
  for (const mapping::GlobalCell& c : map.cells) {
    const auto row = static_cast<size_t>(int64_t{raster.max_y} - c.cell.y);
    const auto column = static_cast<size_t>(int64_t{c.cell.x} - raster.min_x);
    const mapping::GlobalCell*& top = raster.cells[row * raster.width + column];
    if (top == nullptr || top->cell.z <= c.cell.z) top = &c;
  }
  return raster;
}

// ---------- where it is

void placeTiff(TIFF* tiff, const Raster& raster, double cell_size_m, const GeoFrame* frame) {
  // The corner of the first pixel, and what a step to the right and a step down do.
  const double x = (raster.min_x - 0.5) * cell_size_m, y = (raster.max_y + 0.5) * cell_size_m;
  const auto plane = [frame](double dx, double dy) {
    return frame != nullptr ? frame->planeOf(dx, dy) : GeoFrame::Plane{dx, dy};
  };
  const GeoFrame::Plane corner = plane(x, y), right = plane(cell_size_m, 0), down = plane(0, -cell_size_m);
  if (right.north_m == 0 && right.east_m > 0) {
    const std::array<double, 3> scale{cell_size_m, cell_size_m, 0};
    const std::array<double, 6> tie{0, 0, 0, corner.east_m, corner.north_m, 0};
    TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale.data());
    TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie.data());
  } else {
    const std::array<double, 16> matrix{right.east_m,
                                        down.east_m,
                                        0,
                                        corner.east_m,  //
                                        right.north_m,
                                        down.north_m,
                                        0,
                                        corner.north_m,  //
                                        0,
                                        0,
                                        0,
                                        0,  //
                                        0,
                                        0,
                                        0,
                                        1};
    TIFFSetField(tiff, TIFFTAG_GEOTRANSMATRIX, 16, matrix.data());
  }
  const std::unique_ptr<GTIF, void (*)(GTIF*)> keys(GTIFNew(tiff), GTIFFree);
  const auto code = [&keys](geokey_t key, int value) { GTIFKeySet(keys.get(), key, TYPE_SHORT, 1, value); };
  const auto real = [&keys](geokey_t key, double value) {
    GTIFKeySet(keys.get(), key, TYPE_DOUBLE, 1, value);
  };
  const auto text = [&keys](geokey_t key, const char* value) {
    GTIFKeySet(keys.get(), key, TYPE_ASCII, 0, value);
  };
  code(GTRasterTypeGeoKey, RasterPixelIsArea);
  if (frame == nullptr) {
    code(GTModelTypeGeoKey, KvUserDefined);
    text(GTCitationGeoKey, "mission frame, metres");
    code(ProjLinearUnitsGeoKey, Linear_Meter);
  } else {
    code(GTModelTypeGeoKey, ModelTypeProjected);
    text(GTCitationGeoKey, "transverse Mercator around the mission's origin");
    code(GeographicTypeGeoKey, GCS_WGS_84);
    code(GeogAngularUnitsGeoKey, Angular_Degree);
    code(ProjectedCSTypeGeoKey, KvUserDefined);
    code(ProjectionGeoKey, KvUserDefined);
    code(ProjCoordTransGeoKey, CT_TransverseMercator);
    code(ProjLinearUnitsGeoKey, Linear_Meter);
    real(ProjNatOriginLatGeoKey, frame->origin().latitude_deg);
    real(ProjNatOriginLongGeoKey, frame->origin().longitude_deg);
    real(ProjFalseEastingGeoKey, 0);
    real(ProjFalseNorthingGeoKey, 0);
    real(ProjScaleAtNatOriginGeoKey, 1);
  }
  GTIFWriteKeys(keys.get());
}

// ---------- what both pictures share

struct Band {
  uint16_t bits = 8, format = SAMPLEFORMAT_UINT;
  std::string name, no_data;
  std::function<void(TIFF*)> describe;                                         // more tags
  std::function<void(const mapping::GlobalCell* cell, uint8_t* pixel)> write;  // bits / 8 bytes
};

std::string tiffOf(const mapping::MissionView& view, const GeoFrame* frame, const Band& band) {
  static std::once_flag once;
  std::call_once(once, [] {
    XTIFFInitialize();
    parent_extender = TIFFSetTagExtender(addGdalTags);
  });
  const Raster raster = rasterOf(view.map);
  Memory file;
  {
    const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(
        TIFFClientOpen("map.tif", "w", &file, readSome, writeSome, seek, close, sizeOf, nullptr, nullptr),
        TIFFClose);
    if (!tiff) throw std::runtime_error("libtiff cannot write");
    TIFF* t = tiff.get();
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, raster.width);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, raster.height);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, band.bits);
    TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, band.format);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, std::max(1u, 65536u / (raster.width * band.bits / 8)));
    TIFFSetField(t, kGdalNoData, band.no_data.c_str());
    TIFFSetField(t, kGdalMetadata,
                 ("<GDALMetadata><Item name=\"DESCRIPTION\" sample=\"0\" role=\"description\">" + band.name +
                  "</Item></GDALMetadata>")
                     .c_str());
    band.describe(t);
    placeTiff(t, raster, view.cell_size_m, frame);
    std::vector<uint8_t> row(size_t{raster.width} * band.bits / 8);
    for (uint32_t j = 0; j < raster.height; ++j) {
      for (size_t i = 0; i < raster.width; ++i)
        band.write(raster.cells[size_t{j} * raster.width + i], &row[i * band.bits / 8]);
      if (TIFFWriteScanline(t, row.data(), j) < 0) throw std::runtime_error("libtiff cannot write a row");
    }
  }
  return std::move(file.bytes);
}

}  // namespace

std::string labelsGeoTiff(const mapping::MissionView& view, const GeoFrame* frame) {
  std::map<world::GlobalLabel, uint16_t> value_of;
  if (view.map.labels.size() > 65535) throw std::runtime_error("a GeoTIFF tells at most 65535 labels apart");
  for (const mapping::LabelSummary& row : view.map.labels)
    value_of.emplace(row.label, static_cast<uint16_t>(value_of.size() + 1));
  Band band{.name = "label", .no_data = "0", .describe = {}, .write = {}};
  band.bits = value_of.size() > 255 ? 16 : 8;
  band.describe = [&](TIFF* tiff) {
    std::array<std::vector<uint16_t>, 3> colors;
    for (auto& channel : colors) channel.assign(size_t{1} << band.bits, 0);
    for (const auto& [label, value] : value_of) {
      const Rgb color = colorOf(label);
      for (size_t c = 0; c < 3; ++c) colors[c][value] = static_cast<uint16_t>(color[c] * 257);
    }
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_PALETTE);
    TIFFSetField(tiff, TIFFTAG_COLORMAP, colors[0].data(), colors[1].data(), colors[2].data());
  };
  band.write = [&](const mapping::GlobalCell* cell, uint8_t* pixel) {
    uint16_t value = 0;
    if (cell != nullptr) {
      const auto found = value_of.find(cell->label);
      if (found == value_of.end())
        throw std::runtime_error(fmt::format("the legend lacks label {}", world::number(cell->label)));
      value = found->second;
    }
    if (band.bits == 8) {
      *pixel = static_cast<uint8_t>(value);
    } else {
      std::memcpy(pixel, &value, sizeof value);  // libtiff's order is this machine's
    }
  };
  return tiffOf(view, frame, band);
}

std::string certaintyGeoTiff(const mapping::MissionView& view, const GeoFrame* frame) {
  Band band{.bits = 32,
            .format = SAMPLEFORMAT_IEEEFP,
            .name = "certainty",
            .no_data = "nan",
            .describe = {},
            .write = {}};
  band.describe = [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK); };
  band.write = [](const mapping::GlobalCell* cell, uint8_t* pixel) {
    const float value = cell == nullptr ? std::numeric_limits<float>::quiet_NaN() : cell->certainty;
    std::memcpy(pixel, &value, sizeof value);
  };
  return tiffOf(view, frame, band);
}

std::string geotiffLegend(const mapping::MissionView& view) {
  std::string xml =
      "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n      <Category>nobody was "
      "here</Category>\n";
  for (const mapping::LabelSummary& row : view.map.labels) {
    const std::string number = std::to_string(world::number(row.label));
    xml += "      <Category>" +
           (row.name.empty() ? "label " + number : xmlText(row.name) + " (" + number + ")") + "</Category>\n";
  }
  return xml + "    </CategoryNames>\n  </PAMRasterBand>\n</PAMDataset>\n";
}

}  // namespace shoal::console
