// SPDX-License-Identifier: MIT
// The files of technologies/, built in.
#pragma once

#include <string>
#include <vector>

#include "hw/arch/device_link.h"
#include "hw/cost/technology.h"

namespace cuboct {

extern const char kCmos45Technology[];
extern const char kCmos7Technology[];
extern const char kOsu018Technology[];
extern const char kIce40Technology[];
extern const char kEcp5Technology[];
extern const char kLinksTechnology[];
extern const char kMachinePeers[];  // study/machines/peers.h
extern const char kBoardsTechnology[];

// "cmos45", or a file's path: one that has a slash or ends in .toml. InputError with the nearest spelling.
Technology technology_named(const std::string& name);
std::vector<std::string> technology_names();
// "ucie". The technology, its links of this kind between chips.
Technology with_link(Technology technology, const std::string& kind);
std::vector<std::string> link_names();
// Kinds of link between devices: of `file`, or those built in where it is empty.
std::vector<DeviceLinkKind> board_links(const std::string& file);

}  // namespace cuboct
