// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "operator_console/render.h"

namespace shoal::console {

/// Whether standard output is a terminal: only then colours, and only then pictures that redraw.
bool isOnTerminal();

/// The text so that it catches the eye, on a terminal; else as it is. The columns it takes stay the same.
std::string alarming(const std::string& text);

/// Two columns in a colour, on a terminal; else nothing.
std::string swatch(const Rgb& color);

/// The text in exactly `width` columns, one a code point: filled up with spaces, or cut and ended with "~".
std::string shortened(const std::string& text, size_t width);

/// The text in `width` columns, as shortened(), on a terminal; else the whole of it, filled up.
std::string column(const std::string& text, size_t width);

/// The same for what ends a line: without blanks after it.
std::string lastColumn(const std::string& text, size_t width);

/// Clears the terminal and goes to its top left corner; nothing when there is none.
void clearTerminal();

}  // namespace shoal::console
