// SPDX-License-Identifier: BSD-3-Clause
// What topics look like. An image is loaded once for each place on the page that shows it.
import type { Picture } from "./api";
import { el, seconds } from "./dom";

export class Pictures {
  of = ""; // which moment's
  private labels = new Map<number, Picture[]>();
  private topics = new Map<string, Picture[]>();
  private images = new Map<string, HTMLElement>();
  private at = "";

  take(of: string, labels: { label: number; pictures: Picture[] }[], at: string): void {
    this.of = of; this.at = at;
    this.labels = new Map(labels.map((l) => [l.label, l.pictures]));
    this.topics.clear();
    for (const l of labels) for (const p of l.pictures) {
      const key = p.robot + "/" + p.topic;
      this.topics.set(key, [...(this.topics.get(key) ?? []), p]);
    }
    if (this.images.size > 4000) this.images.clear();
  }

  ofLabel(label: number): Picture[] { return this.labels.get(label) ?? []; }
  ofTopic(robot: string, topic: number): Picture[] { return this.topics.get(robot + "/" + topic) ?? []; }

  // The image for one place, such as "legend"; the same element again and again while the picture stays the same.
  image(place: string, p: Picture): HTMLElement {
    const src = `/api/picture?robot=${p.robot}&topic=${p.topic}&example=${p.example}${this.at}&v=${p.seen_s}-${p.layers}`;
    const key = place + src;
    let image = this.images.get(key);
    if (!image) {
      const sharp = p.layers < p.num_layers ? ", getting sharper" : "";
      image = el("img", { src, class: "example", alt: `as ${p.robot} saw it`, title: `as ${p.robot} saw it at ${seconds(p.seen_s)}${sharp}` });
      this.images.set(key, image);
    }
    return image;
  }
}
