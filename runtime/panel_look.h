#pragma once
// What panels look like: a font of the system's, quiet colours.

namespace promenade {

/// The font and the colours of all panels. Where the system has no font that can be read, Dear ImGui's own. scale:
/// pixels of the display over the usual. Once, between Dear ImGui's context and its first frame. Thread: the main one.
void set_panel_look(float scale);

}  // namespace promenade
