const lists = {};
for (const element of document.querySelectorAll("script[id^=pictures-]")) lists[element.id] = JSON.parse(element.textContent);
// Shows, in every figure of a slider's section, the picture at the slider's share of the run.
for (const group of document.querySelectorAll("[data-pictures]")) {
  const slider = group.querySelector("input[type=range]");
  if (!slider) continue;
  const show = () => {
    const share = Number(slider.max) > 0 ? Number(slider.value) / Number(slider.max) : 0;
    for (const figure of group.querySelectorAll("figure")) {
      const list = lists[figure.dataset.list];
      const [label, data] = list[Math.round(share * (list.length - 1))];
      figure.querySelector("img").src = "data:image/png;base64," + data;
      figure.querySelector("figcaption output").textContent = label;
    }
  };
  slider.addEventListener("input", show);
  slider.hidden = false;
}
