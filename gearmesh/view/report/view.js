// The view of the report page. Its data stand in the page; scene.js draws them.
(function () {
  "use strict";

  const element = (id) => document.getElementById(id);

  for (const button of document.querySelectorAll("button.copy")) {
    const text = button.textContent;
    button.addEventListener("click", async () => {
      const pre = button.nextElementSibling;
      try {
        await navigator.clipboard.writeText(pre.textContent);
      } catch {
        const range = document.createRange();
        range.selectNodeContents(pre);
        getSelection().removeAllRanges();
        getSelection().addRange(range);
        document.execCommand("copy");
      }
      button.textContent = "Copied";
      setTimeout(() => { button.textContent = text; }, 1500);
    });
  }

  const scene = window.gearmeshScene();
  if (!scene) return;
  element("stand-in").hidden = true;
  scene.show(JSON.parse(element("stage").textContent));
  window.gearmeshView = scene;
  // the gears turn until somebody moves the slider, or the reader's system asks for stillness
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches && !element("play").disabled) scene.roll(true);
})();
