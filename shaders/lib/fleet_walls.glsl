// The walls whose bounding boxes meet a box, in the order of the tree (base/box_tree.h).

/// Position in the tree: the next node, and the walls of a leaf.
struct WallWalk {
  int node, at, end;
};

/// (x_min, y_min, x_max, y_max)
dvec4 box_around(dvec2 p, double reach) {
  precise dvec4 box = dvec4(p.x - reach, p.y - reach, p.x + reach, p.y + reach);
  return box;
}

bool boxes_meet(dvec4 a, dvec4 b) { return a.x <= b.z && b.x <= a.z && a.y <= b.w && b.y <= a.w; }

dvec4 box_of(FleetWall wall) {
  return dvec4(least(wall.ax, wall.bx), least(wall.ay, wall.by), most(wall.ax, wall.bx), most(wall.ay, wall.by));
}

/// Moves to the first wall from here on, `walk.at`. Returns false if there is none.
bool find_wall(inout WallWalk walk, dvec4 box) {
  const int count = int(load_FleetTick(tick, 0).nodes);
  bool found = false;
  while (may_turn(1u) && !found && (walk.at < walk.end || walk.node < count)) {
    if (walk.at < walk.end) {
      found = boxes_meet(box, box_of(load_FleetWall(walls, walk.at)));
      walk.at += found ? 0 : 1;
    } else {
      const FleetNode node = load_FleetNode(nodes, walk.node);
      const bool near = boxes_meet(dvec4(node.x_min, node.y_min, node.x_max, node.y_max), box);
      walk.at = int(node.first);
      walk.end = int(node.first + (near ? node.count : 0u));
      walk.node = near ? walk.node + 1 : int(node.end);
    }
  }
  return found;
}
