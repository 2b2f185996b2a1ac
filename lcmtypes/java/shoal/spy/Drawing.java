// SPDX-License-Identifier: BSD-3-Clause
package shoal.spy;

import java.awt.Color;
import java.awt.Font;
import java.awt.Graphics2D;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;

/** Draws a robot's own map, seen from above, and its descriptors: a strip of bars for each topic. */
public final class Drawing {
  private static final Color BACK = new Color(0xE1E1E1), INK = new Color(0x303030);
  private static final int ROW = 26, NAME = 96, GAP = 6;

  private Drawing() {}

  private static long mix(long x) {
    x += 0x9E3779B97F4A7C15L;
    x = (x ^ x >>> 30) * 0xBF58476D1CE4E5B9L;
    x = (x ^ x >>> 27) * 0x94D049BB133111EBL;
    return x ^ x >>> 31;
  }

  /** The colour of a topic: the one that all of Shoal's pictures of a robot's own map give it. */
  public static Color colorOf(long topic) {
    long value = mix(topic + 17);
    long hue = Long.remainderUnsigned(value, 180), saturation = 110 + (value >>> 16) % 130;
    long brightness = 130 + (value >>> 32) % 115;
    return new Color(Color.HSBtoRGB(hue / 180f, saturation / 255f, brightness / 255f));
  }

  /** The cells that Team.cells() gives, north up, the highest on top. */
  public static void map(Graphics2D g, Map<List<Integer>, long[]> cells, int width, int height) {
    g.setColor(BACK);
    g.fillRect(0, 0, width, height);
    TreeMap<Integer, TreeMap<Integer, List<Integer>>> top = new TreeMap<>();  // x -> y -> the highest cell
    long x0 = Long.MAX_VALUE, x1 = Long.MIN_VALUE, y0 = x0, y1 = x1;
    for (List<Integer> cell : cells.keySet()) {
      x0 = Math.min(x0, cell.get(0));
      x1 = Math.max(x1, cell.get(0));
      y0 = Math.min(y0, cell.get(1));
      y1 = Math.max(y1, cell.get(1));
      top.computeIfAbsent(cell.get(0), k -> new TreeMap<>())
          .merge(cell.get(1), cell, (a, b) -> a.get(2) > b.get(2) ? a : b);
    }
    if (cells.isEmpty()) {
      g.setColor(INK);
      g.drawString("nothing heard of its map yet", 12, 24);
      return;
    }
    double scale = Math.min(width / (double) (x1 - x0 + 1), height / (double) (y1 - y0 + 1));
    if (scale > 1) scale = Math.floor(scale);
    double left = (width - (x1 - x0 + 1) * scale) / 2, up = (height - (y1 - y0 + 1) * scale) / 2;
    int edge = (int) Math.max(1, Math.ceil(scale));
    for (Map<Integer, List<Integer>> column : top.values()) {
      for (List<Integer> cell : column.values()) {
        g.setColor(colorOf(cells.get(cell)[0]));
        g.fillRect((int) (left + (cell.get(0) - x0) * scale), (int) (up + (y1 - cell.get(1)) * scale), edge, edge);
      }
    }
  }

  /** How high descriptors() draws so many topics. */
  public static int heightOf(int topics) { return ROW * Math.max(1, topics) + 20; }

  /** The topics that Team.topics() gives, a row each: a strip a word group, words from left to right by number. */
  public static void descriptors(Graphics2D g, TreeMap<Integer, Piece> topics, int width) {
    g.setColor(Color.WHITE);
    g.fillRect(0, 0, width, heightOf(topics.size()));
    g.setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 11));
    if (topics.isEmpty()) {
      g.setColor(INK);
      g.drawString("nothing heard of its topics yet", 12, 24);
      return;
    }
    int y = 16;
    int[] first = topics.firstEntry().getValue().groups;
    int each = Math.max(8, (width - NAME - GAP * (first.length + 1)) / Math.max(1, first.length));
    g.setColor(INK);
    for (int group = 0; group < first.length; ++group)
      g.drawString(each < 110 ? "" + first[group] : first[group] + " words", NAME + group * (each + GAP), 12);
    for (Map.Entry<Integer, Piece> entry : topics.entrySet()) {
      Piece topic = entry.getValue();
      Color color = colorOf(entry.getKey());
      g.setColor(color);
      g.fillRect(4, y + 4, 14, ROW - 8);
      g.setColor(INK);
      g.drawString(entry.getKey() + "  (" + topic.weight + ")", 24, y + ROW - 9);
      int begin = 0;
      for (int group = 0; group < topic.groups.length; ++group) {
        strip(g, topic, begin, topic.groups[group], NAME + group * (each + GAP), y, each, color);
        begin += topic.groups[group];
      }
      y += ROW;
    }
  }

  private static void strip(Graphics2D g, Piece topic, int begin, int size, int left, int top, int width, Color color) {
    long[] bars = new long[Math.min(width, size)];
    long most = 1;
    for (Map.Entry<Integer, Integer> word : topic.words.subMap(begin, begin + size).entrySet()) {
      int bar = (int) ((word.getKey() - begin) * (long) bars.length / size);
      bars[bar] += word.getValue();
      most = Math.max(most, bars[bar]);
    }
    g.setColor(new Color(0xF2F2F2));
    g.fillRect(left, top + 2, width, ROW - 4);
    g.setColor(color.darker());
    for (int i = 0; i < bars.length; ++i) {
      int high = (int) ((ROW - 4) * bars[i] / most);
      int x = left + (int) ((long) i * width / bars.length), next = left + (int) ((long) (i + 1) * width / bars.length);
      g.fillRect(x, top + ROW - 2 - high, Math.max(1, next - x), high);
    }
  }
}
